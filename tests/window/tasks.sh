#!/usr/bin/env bash
# The work of an operator in a real window under Xvfb, by touch alone, and how many touches and seconds each task takes:
# from a cold start to a ground part, a value by its number in the picture, a correction from a measured size, dressing,
# a parameter by the search, an order of 50 parts. A story on the data that are left checks that everything was done.
# Half a second from touch to touch. Needs Xvfb and xdotool; without them it says that nothing was tested.
# KT830_WINDOW_PROGRAM names a built program, so that nothing is built here.
set -euo pipefail
cd "$(dirname "$0")/../.."
# shellcheck source=tests/window/needs.sh
source tests/window/needs.sh
need tests/window/tasks Xvfb xdotool
find_program
work=$(mktemp -d)
clean() {
  # shellcheck disable=SC2046
  kill $(jobs -p) 2>/dev/null || true
  rm -rf "$work"
}
trap clean EXIT
export DISPLAY=":${KT830_WINDOW_DISPLAY:-93}"
Xvfb "$DISPLAY" -screen 0 1024x768x24 >/dev/null 2>&1 &
sleep 1
"$program" --kind gc --lang zh --data "$work/data" >"$work/said" 2>&1 &
pid=$!
timeout 60 xdotool search --sync --onlyvisible --name KT-830 >/dev/null
sleep 5

# Touches places one after the other: X Y each.
touch_at() {
  while [[ $# -gt 1 ]]; do
    xdotool mousemove "$1" "$2" mousedown 1
    sleep 0.1
    xdotool mouseup 1
    sleep 0.4
    touches=$((touches + 1))
    shift 2
  done
}

# Types digits on the tall pad of the grinding page.
type_tall() {
  local digits=$1 place
  for ((at = 0; at < ${#digits}; at++)); do
    case ${digits:at:1} in
      7) place="587 246" ;; 8) place="653 246" ;; 9) place="718 246" ;;
      4) place="587 301" ;; 5) place="653 301" ;; 6) place="718 301" ;;
      1) place="587 356" ;; 2) place="653 356" ;; 3) place="718 356" ;;
      0) place="653 411" ;; .) place="718 411" ;;
    esac
    # shellcheck disable=SC2086
    touch_at $place
  done
  touch_at 685 493
}

begin() {
  touches=0
  since=$(date +%s%N)
}

told() {
  printf '%-48s %3d touches %6.1f s\n' "$1" "$touches" "$((($(date +%s%N) - since) / 100000000))e-1"
}

# What the start guide says: home, X+, Z+, a program, hydraulics, AUTO, cycle start.
begin
touch_at 173 611 836 498
sleep 7
touch_at 886 546
sleep 7
touch_at 359 611 300 185 677 185
touch_at 105 575
sleep 4
touch_at 477 575 803 718
told "cold start to the start of the part (O1002)"
sleep 42
told "… to the ground part"

begin
touch_at 653 524
type_tall 40.006
# Where the pad was, the page takes no touch for 0.6 s.
sleep 0.4
touch_at 653 472
told "type a measured size, take the correction"

begin
touch_at 728 79 569 370
type_tall 39.9
told "a value by its number in the picture"

begin
touch_at 643 742 568 742 457 75 365 562 803 718
told "dress from the assistant, to its start"
sleep 100
# Back to O1002.
touch_at 457 562
sleep 1

begin
touch_at 685 23 588 470 112 424 429 424 588 424 466 321
told "find P270 by the search"

begin
touch_at 685 742 115 591 600 142
# 701, the program as it is, 50 on the wide pad; ENTER, START.
touch_at 536 419 597 583 536 529 719 556 719 556 597 474 597 583 719 556 83 585 232 585
told "a new order of 50 parts, started"
sleep 2
kill "$pid"
wait "$pid" 2>/dev/null || true
cat >"$work/story" <<'STORY'
expect #521 39.9
expect wear 1 X -0.056
expect #5805 1
page jobs
wait 0.2 s
expect page jobs shows "701"
expect page jobs shows "0 / 50"
expect page jobs shows "进行"
STORY
"$program" --kind gc --lang zh --data "$work/data" play "$work/story"
