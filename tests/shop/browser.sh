#!/usr/bin/env bash
# The view for browsers in a real one: Chromium, headless. On this computer without a password, then as another computer
# sees it, in TLS and with the password of the viewers. KT830_PROGRAM names the program, KT830_PICTURES a folder that keeps
# the pictures.
set -euo pipefail
cd "$(dirname "$0")/../.."
if ! command -v chromium >/dev/null; then
  echo "tests/shop: there is no chromium; NOTHING was tested"
  exit 0
fi
[[ -n "${KT830_PROGRAM:-}" ]] || cargo build --locked --quiet --bin kt830
program=${KT830_PROGRAM:-target/debug/kt830}
port=${KT830_PORT:-8090}
work=$(mktemp -d)
pictures=${KT830_PICTURES:-$work}
served=
trap '[[ -z "$served" ]] || kill "$served" 2>/dev/null || true; rm -rf "$work"' EXIT
failed=0
check() {
  local what=$1
  shift
  if "$@" >"$work/said" 2>&1; then echo "  $what"; else
    echo "  FAILED: $what"
    tail -c 600 "$work/said"
    failed=$((failed + 1))
  fi
}
browse() {
  timeout 60 chromium --headless --no-sandbox --disable-gpu --user-data-dir="$work/profile" --ignore-certificate-errors --lang=en "$@" 2>/dev/null
}
has() { grep -q "$1" "$work/dom"; }

"$program" serve assets/stories/first_part.story --data "$work/data" --param P482=123 --param P483="$port" >/dev/null 2>"$work/log" &
served=$!
sleep 15
echo "on this computer"
browse --virtual-time-budget=8000 --dump-dom "http://localhost:$port/" >"$work/dom"
check "the machine is named" has "kt830-gc-000123"
check "its program is shown" has "O1002"
check "its axes are shown" has "<dt class=\"axis\">X</dt>"
check "its state is a word" grep -Eq 'data-state="(ACTIVE|READY|STOPPED|WAIT|FEED_HOLD|PROGRAM_STOPPED)"' "$work/dom"
browse --window-size=412,1500 --virtual-time-budget=8000 --screenshot="$pictures/phone.png" "http://localhost:$port/"
check "a phone shows it" test -s "$pictures/phone.png"
check "nobody else's page frames it" bash -c "curl -s -i http://localhost:$port/ | grep -q \"frame-ancestors 'none'\""
kill "$served"
wait "$served" 2>/dev/null || true

echo "from another computer"
echo "correct horse" | "$program" web-access localhost --data "$work/data"
"$program" serve assets/stories/first_part.story --data "$work/data" --param P482=123 --param P483="$port" --param P486=1 >/dev/null 2>"$work/log" &
served=$!
sleep 15
check "not without the password" bash -c "[[ \$(curl -sk -o /dev/null -w '%{http_code}' https://localhost:$port/) == 401 ]]"
check "with the password" bash -c "curl -sf --cacert '$work/data/web.pem' -u viewer:'correct horse' https://localhost:$port/state.json | grep -q kt830-gc-000123"
check "not without TLS" bash -c "! curl -s http://localhost:$port/state.json"
check "not with TLS 1.1" bash -c "! curl -sk --tls-max 1.1 -u viewer:'correct horse' https://localhost:$port/"
# The page of a password asks for its data with the password, too.
browse --virtual-time-budget=8000 --dump-dom "https://viewer:correct%20horse@localhost:$port/" >"$work/dom" || true
check "Chromium shows the page" has "id=\"machine\""
echo "$failed failed"
[[ $failed -eq 0 ]]
