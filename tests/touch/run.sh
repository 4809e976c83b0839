#!/usr/bin/env bash
# Touches the real window: taps, swipes, pinches, and jog keys under two fingers, on a display with a touch screen that needs
# no hardware (Xorg with the drivers dummy and inputtest). check.py touches and measures, touch.py is the touch screen.
# Needs Xorg with both drivers, xinput, xdotool and ImageMagick; without them it says that nothing was tested.
# KT830_WINDOW_PROGRAM names a built program, so that nothing is built here; KT830_WINDOW_PICTURES a folder for pictures.
set -euo pipefail
cd "$(dirname "$0")/../.."
modules=/usr/lib/xorg/modules
# shellcheck source=tests/window/needs.sh
source tests/window/needs.sh
need tests/touch Xorg xinput xdotool import
for needed in input/inputtest_drv.so drivers/dummy_drv.so; do
  if [[ ! -e "$modules/$needed" ]]; then
    echo "tests/touch: '$modules/$needed' is missing; NOTHING was tested"
    exit 0
  fi
done
find_program
program=$(realpath "$program")
work=$(mktemp -d)
port=$((20000 + RANDOM % 10000))
clean() {
  # shellcheck disable=SC2046
  kill $(jobs -p) 2>/dev/null || true
  wait
  rm -rf "$work"
}
trap clean EXIT

cat >"$work/xorg.conf" <<END
Section "ServerFlags"
  Option "AutoAddDevices" "false"
EndSection
Section "Device"
  Identifier "card"
  Driver "dummy"
EndSection
Section "Monitor"
  Identifier "monitor"
  HorizSync 5-1000
  VertRefresh 5-200
  Modeline "1024x768" 63.5 1024 1072 1176 1328 768 771 775 798
EndSection
Section "Screen"
  Identifier "screen"
  Device "card"
  Monitor "monitor"
  DefaultDepth 24
  SubSection "Display"
    Modes "1024x768"
  EndSubSection
EndSection
Section "InputDevice"
  Identifier "finger"
  Driver "inputtest"
  Option "DeviceType" "Touch"
  Option "SocketPath" "$work/finger"
EndSection
Section "InputDevice"
  Identifier "keys"
  Driver "inputtest"
  Option "DeviceType" "Keyboard"
  Option "SocketPath" "$work/keys"
EndSection
Section "ServerLayout"
  Identifier "layout"
  Screen "screen"
  InputDevice "finger" "CorePointer"
  InputDevice "keys" "CoreKeyboard"
EndSection
END
# The machine is prepared unseen; whoever touches it has it then, and it is not taken back within a minute.
cat >"$work/story" <<END
kind gc
power on
key hydraulic
wait 4 s
load O1002
home all
mode manual
page graphic
prepared
wait 900 s
END

# The server writes the number of the first free display.
Xorg -displayfd 3 -config "$work/xorg.conf" -logfile "$work/xorg.log" -noreset -novtswitch -sharevts -nolisten tcp \
  3>"$work/display" >/dev/null 2>&1 &
for _ in $(seq 100); do
  [[ -s "$work/display" ]] && break
  sleep 0.1
done
if [[ ! -s "$work/display" ]]; then
  echo "tests/touch: Xorg does not start"
  tail -20 "$work/xorg.log"
  exit 1
fi
DISPLAY=:$(<"$work/display")
export DISPLAY LIBGL_ALWAYS_SOFTWARE=1
here=$PWD
# Not where the programs of the repository are: the shipped ones are used.
cd "$work"
"$program" --kind gc --lang en --data "$work/data" --param "P483=$port" demo "$work/story" >"$work/said" 2>&1 &
timeout 60 xdotool search --sync --onlyvisible --name KT-830 >"$work/window"
if ! python3 "$here/tests/touch/check.py" "$work/finger" "$port" "$(tail -1 "$work/window")" "${KT830_WINDOW_PICTURES:-}"; then
  cat "$work/said"
  exit 1
fi
