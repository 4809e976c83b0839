#!/usr/bin/env bash
# Plays every scenario on a rig of EtherCAT devices, each in a network of its own, and fails if one fails.
# KT830_ETHERCAT_RIG names the folder of the rig: its program `rig` runs a command on the machine. With names of
# scenarios as arguments only those are played.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [[ -z "${KT830_ETHERCAT_RIG:-}" || ! -x "${KT830_ETHERCAT_RIG}/rig" ]]; then
  echo "tests/rig: no rig here: KT830_ETHERCAT_RIG does not name a folder with the program 'rig'; NOTHING was tested"
  exit 0
fi
cargo build --locked --quiet --bin kt830
cargo test --locked --quiet --test rig --no-run
played=$(cargo test --locked --test rig --no-run --message-format=json 2>/dev/null |
  grep -o '"executable":"[^"]*/rig-[^"]*"' | tail -1 | cut -d'"' -f4)
kt830=$(dirname "$played")/../kt830
on_rig() { "$KT830_ETHERCAT_RIG/rig" -- "$@"; }
export RUST_BACKTRACE=0
failed=0
for scenario in ${@:-$("$played")}; do
  on_rig "$played" "$scenario" 2>/dev/null || { failed=$((failed + 1)); }
done
if [[ $# -eq 0 ]]; then
  echo "without_rights"
  told=$(on_rig setpriv --inh-caps=-all --bounding-set=-net_raw "$kt830" bus tests/rig/machine.ron --lang en 2>&1) && failed=$((failed + 1))
  grep -q "setcap cap_net_raw" <<< "$told" && grep -q "no permission" <<< "$told" || failed=$((failed + 1))
  echo "$told" | head -2 | sed 's/^/  /'
  echo "process_killed"
  # The watchdogs of the devices switch the outputs off (100 ms).
  log=$(mktemp)
  on_rig bash -c 'PLANT_LOG=$KT_ETHERCAT_LOG; ("$1" hold & child=$!; sleep 20; kill -9 $child; sleep 1; cp "$PLANT_LOG" "$2")' _ "$played" "$log" > /dev/null 2>&1 || true
  if grep '"output"' "$log" | grep '"wheel"' | tail -1 | grep -q '"value": 0'; then echo "  wheel off by the watchdog"; else
    echo "  FAILED: the wheel is still on"; failed=$((failed + 1)); fi
  rm -f "$log"
fi
if [[ $failed -gt 0 ]]; then echo "$failed FAILED"; exit 1; fi
echo "all good"
