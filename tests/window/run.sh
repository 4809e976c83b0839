#!/usr/bin/env bash
# Ends the control in a real window under Xvfb in every way and in every state, and starts it again on the same data:
# signals, Ctrl+Q, Alt+F4, closing by the window manager, a killed X server. In a run the window manager and its keys
# close nothing. The last outputs of each state are in `cargo test --test control process_end`.
# Needs Xvfb, openbox, xdotool and wmctrl; without them it says that nothing was tested.
# KT830_WINDOW_PROGRAM names a built program, so that nothing is built here.
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source=tests/window/needs.sh
source tests/window/needs.sh
need tests/window Xvfb openbox xdotool wmctrl
find_program
work=$(mktemp -d)
failed=0
number=90
clean() {
  # shellcheck disable=SC2046
  kill $(jobs -p) 2>/dev/null || true
  rm -rf "$work"
}
trap clean EXIT

prepared=$'set #500 = 7.5\nkey hydraulic\nwait 4 s\nhome all\nmode auto\nload O7000\nkey cycle-start\nwait 1 s'
# What brings the control into each state, how many seconds of a real display that takes, and the next start.
declare -A story=([idle]=$'set #500 = 7.5\nkey hydraulic' [run]="$prepared" [held]="$prepared"$'\nkey feed-hold\nwait 1 s')
declare -A seconds=([idle]=10 [run]=22 [held]=22)
# An end in a run is alarm 403 in the history, and the place of the program is kept.
interrupted=$'page alarm\nexpect page alarm shows "HISTORY 1"\nexpect page alarm shows "RESUME O7000 line"'
declare -A next=([idle]=$'page alarm\nexpect page alarm shows "HISTORY 0"' [run]="$interrupted" [held]="$interrupted")

# Opens a window in a state: sets `pid`, `server`, `data` and DISPLAY.
open_in() {
  number=$((number + 1))
  export DISPLAY=":$number"
  data="$work/$number"
  mkdir -p "$data/programs"
  printf 'O7000\nG98\nN10 G01 X-5 F300\nX0\nM99 P10\n' >"$data/programs/O7000.NC"
  printf '%s\nwait 60 s\n' "${story[$1]}" >"$work/story"
  Xvfb "$DISPLAY" -screen 0 1024x768x24 >/dev/null 2>&1 &
  server=$!
  sleep 1
  openbox >/dev/null 2>&1 &
  "$program" --kind gc --lang en --data "$data" --programs "$data/programs" demo "$work/story" >"$work/said" 2>&1 &
  pid=$!
  timeout 60 xdotool search --sync --onlyvisible --name KT-830 >/dev/null
  sleep "${seconds[$1]}"
}

apply() {
  case $1 in
    TERM | INT | HUP | QUIT | USR1 | ALRM) kill "-$1" "$pid" ;;
    Ctrl+Q) xdotool key ctrl+q ;;
    Alt+F4) xdotool key alt+F4 ;;
    close) wmctrl -c KT-830 ;;
    X-killed) kill -KILL "$server" ;;
  esac
}

# Whether the process ends within ten seconds; sets `took` (ms).
ends() {
  local since
  since=$(date +%s%N)
  for _ in $(seq 200); do
    took=$((($(date +%s%N) - since) / 1000000))
    kill -0 "$pid" 2>/dev/null || return 0
    sleep 0.05
  done
  return 1
}

fail() {
  echo "  FAILED: $1"
  failed=$((failed + 1))
}

starts_again() {
  printf 'expect #500 7.5\n%s\n' "${next[$1]}" >"$work/next"
  "$program" --kind gc --lang en --data "$data" --programs "$data/programs" play "$work/next" >"$work/played" 2>&1
}

for state in idle run held; do
  for end in TERM INT HUP QUIT USR1 ALRM Ctrl+Q Alt+F4 close X-killed; do
    open_in "$state"
    apply "$end"
    asks=no
    if [[ "$end" =~ ^(Ctrl\+Q|Alt\+F4|close)$ ]]; then
      # Never at once: refused, or a question. Ctrl+Q is no key of this control.
      asks=yes
      sleep 2
      kill -0 "$pid" 2>/dev/null || fail "$end in $state closes the window without a question"
      import -window root "$work/$state-$end.png" 2>/dev/null || true
      kill -TERM "$pid" 2>/dev/null || true
    fi
    if ! ends; then fail "$end in $state: the process goes on"; fi
    kill "$server" 2>/dev/null || true
    if starts_again "$state"; then
      if [[ $asks == yes ]]; then echo "  $end in $state: stays open; ended by TERM in $took ms; all kept"; else
        echo "  $end in $state: ended in $took ms; all kept"
      fi
    else
      fail "$end in $state: the next start is not as it should be"
      grep FAIL "$work/played" | cut -c1-900
    fi
  done
done
[[ -n "${KT830_WINDOW_PICTURES:-}" ]] && cp "$work"/*.png "$KT830_WINDOW_PICTURES"
if ((failed > 0)); then
  echo "tests/window: $failed FAILED"
  exit 1
fi
echo "tests/window: all good"
