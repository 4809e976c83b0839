#!/usr/bin/env bash
# Holds what the control tells the network against the schema of MTConnect. KT830_MTCONNECT_SCHEMA names a folder with
# MTConnectDevices_2.2.xsd, MTConnectStreams_2.2.xsd and xlink.xsd (github.com/mtconnect/schema); Python needs the
# package xmlschema.
set -euo pipefail
cd "$(dirname "$0")/../.."
if [[ ! -f "${KT830_MTCONNECT_SCHEMA:-}/MTConnectDevices_2.2.xsd" ]]; then
  echo "tests/shop: KT830_MTCONNECT_SCHEMA does not name a folder with the schema of MTConnect; NOTHING was tested"
  exit 1
fi
[[ -n "${KT830_PROGRAM:-}" ]] || cargo build --locked --quiet --bin kt830
program=${KT830_PROGRAM:-target/debug/kt830}
port=${KT830_PORT:-7878}
work=$(mktemp -d)
served=
trap '[[ -z "$served" ]] || kill "$served" 2>/dev/null || true; rm -rf "$work"' EXIT
for kind in gc gs ga vertical lathe; do
  "$program" device-model --kind "$kind" --data "$work/data-$kind" --param P482=123 > "$work/$kind.xml"
done
"$program" serve tests/shop/whole.story --programs tests/shop/programs --param P480="$port" --param P482=123 --seconds 130 2> "$work/serve.log" &
served=$!
python3 tests/shop/validate.py "$KT830_MTCONNECT_SCHEMA" "$work" "$port" 115
