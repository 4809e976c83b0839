#!/usr/bin/env bash
# Builds the Debian package and, in a clean Debian root: installs it, runs the control as its own user, updates it, takes
# the update back, removes it. Needs root, `cargo deb` and `mmdebstrap`; without them it says that nothing was tested.
# KT830_PACKAGE_PROGRAM names a built program, so that nothing is built here.
set -euo pipefail
cd "$(dirname "$0")/../.."
for needed in mmdebstrap dpkg-deb; do
  if ! command -v "$needed" >/dev/null; then
    echo "tests/package: '$needed' is missing; NOTHING was tested"
    exit 0
  fi
done
if [[ $(id -u) -ne 0 ]] || ! cargo deb --version >/dev/null 2>&1; then
  echo "tests/package: needs root and 'cargo install cargo-deb'; NOTHING was tested"
  exit 0
fi
work=$(mktemp -d)
root="$work/root"
trap 'rm -rf "$work"' EXIT
if [[ -n "${KT830_PACKAGE_PROGRAM:-}" ]]; then
  export CARGO_TARGET_DIR="$work/target"
  install -D "$KT830_PACKAGE_PROGRAM" "$CARGO_TARGET_DIR/release/kt830"
else
  cargo build --locked --release --features opcua
fi
package() { cargo deb --no-build --quiet --no-strip --deb-version "$1" -o "$work/kt830_$1.deb" >/dev/null; }
package 0.1.0-1
package 0.1.0-2

failed=0
check() {
  local what=$1
  shift
  if "$@" >"$work/said" 2>&1; then echo "  $what"; else
    echo "  FAILED: $what"
    sed 's/^/    /' "$work/said" | tail -5
    failed=$((failed + 1))
  fi
}
within() { chroot "$root" "$@"; }
as_kt830() { within setpriv --reuid kt830 --regid kt830 --init-groups sh -c "cd /var/lib/kt830 && $1"; }
data() { find "$root/var/lib/kt830" -type f -exec sha256sum {} + | sort; }
put() {
  cp "$work/kt830_$1.deb" "$root/tmp/"
  within env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends --allow-downgrades "/tmp/kt830_$1.deb"
}
is_version() { [[ $(within dpkg-query -W -f '${Version}' kt830) == "$1" ]]; }
same_data() { diff <(data) "$work/data"; }
gone() { [[ ! -e "$root/$1" ]]; }

echo "a clean root"
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
# Its dependencies by name: without versions and alternatives.
depends=$(dpkg-deb -f "$work/kt830_0.1.0-1.deb" Depends | sed 's/([^)]*)//g; s/|[^,]*//g; s/ //g')
mmdebstrap --quiet --variant=apt --include="systemd,udev,desktop-file-utils,$depends" "$suite" "$root"
echo "install"
check "is installed" put 0.1.0-1
check "has the rights of a real machine" sh -c "chroot '$root' getcap /usr/bin/kt830 | grep -q cap_net_raw"
check "all libraries are there" sh -c "! chroot '$root' ldd /usr/bin/kt830 | grep 'not found'"
check "the unit is right" within systemd-analyze verify /usr/lib/systemd/system/kt830-kiosk.service
check "the unit of OPC UA is right" within systemd-analyze verify /usr/lib/systemd/system/kt830-opcua.service
check "OPC UA is in it" sh -c "chroot '$root' kt830 opcua --help | grep -q add-user"
check "the rules are right" sh -c "! chroot '$root' udevadm verify /usr/lib/udev/rules.d/70-kt830.rules | grep -i fail"
check "the desktop entry is right" within desktop-file-validate /usr/share/applications/kt830.desktop
check "the icon is there" test -s "$root/usr/share/icons/hicolor/256x256/apps/kt830.png"
check "the kiosk says what is missing" sh -c "chroot '$root' /usr/lib/kt830/kiosk 2>&1 | grep -q 'apt install'"
check "a program runs as the user of the control" as_kt830 "kt830 run O1002 --data /var/lib/kt830"
check "its data are its own" sh -c "[ -n \"\$(find '$root/var/lib/kt830' -type f -user \$(chroot '$root' id -u kt830))\" ]"
echo "kiosk"
# An X server without a display in place of the one on the terminal, and a Wayland compositor without one. Terminal, login
# and restart belong to the service.
tools() {
  within apt-get update -qq
  within env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends xinit xvfb x11-utils cage xwayland
}
check "has what both sessions need" tools
cp "$root/etc/default/kt830" "$work/default"
sed -i 's|^KT830_XSERVER=.*|KT830_XSERVER="/usr/bin/Xvfb :29 -screen 0 1280x720x24"|' "$root/etc/default/kt830"
install -d -m 1777 "$root/dev/shm" "$root/tmp/.X11-unix"
install -d -m 700 -o "$(within id -u kt830)" -g "$(within id -g kt830)" "$root/run/kt830"
headless=(XDG_RUNTIME_DIR=/run/kt830 WLR_BACKENDS=headless WLR_RENDERER=pixman WLR_LIBINPUT_NO_DEVICES=1)
session=
# Processes of its own, which end with it.
start_kiosk() {
  # Shared memory belongs to a running system: without it a Wayland compositor has nothing to draw into.
  unshare --pid --fork --kill-child --mount --mount-proc="$root/proc" sh -c 'mount -t tmpfs -o mode=1777 tmpfs "$1/dev/shm"; shift; exec chroot "$@"' \
    _ "$root" "$root" setpriv --reuid kt830 --regid kt830 --init-groups env HOME=/var/lib/kt830 "${headless[@]}" /usr/lib/kt830/kiosk >"$work/kiosk" 2>&1 &
  session=$!
}
trap '[[ -z "$session" ]] || kill -KILL "$session" 2>/dev/null; rm -rf --one-file-system "$work"' EXIT
control_below() {
  local child
  for child in $(ps -o pid= --ppid "$1"); do
    if [[ $(ps -o comm= -p "$child") == kt830 ]]; then echo "$child"; else control_below "$child"; fi
  done
}
# The display of a Wayland session is that of its user alone.
windows() { within setpriv --reuid kt830 --regid kt830 --init-groups xwininfo -display "$1" -root -tree; }
fills_the_screen() {
  local display
  for _ in $(seq 60); do
    for display in "$@"; do
      if windows "$display" 2>/dev/null | grep -q 'KT-830.* 1280x720+0+0'; then return 0; fi
    done
    sleep 0.5
  done
  for display in "$@"; do windows "$display"; done
  cat "$work/kiosk"
  return 1
}
ends_with_the_control() {
  kill "-$1" "$(control_below "$session")"
  for _ in $(seq 40); do
    if ! kill -0 "$session" 2>/dev/null; then return 0; fi
    sleep 0.25
  done
  return 1
}
start_kiosk
check "fills the screen" fills_the_screen :29
check "ends when the control fails, so that the service starts it again" ends_with_the_control KILL
start_kiosk
check "fills the screen again" fills_the_screen :29
check "ends with the control" ends_with_the_control TERM
sed -i 's|^KT830_SESSION=.*|KT830_SESSION=wayland|' "$root/etc/default/kt830"
start_kiosk
check "fills the screen on Wayland" fills_the_screen :0 :1 :2 :3
check "ends with the control" ends_with_the_control TERM
mv "$work/default" "$root/etc/default/kt830"
echo operator >"$root/var/lib/kt830/programs/O7001.NC"
data >"$work/data"
sed -i 's/^KT830_ARGS=.*/KT830_ARGS="--lang en"/' "$root/etc/default/kt830"
echo "update"
check "is installed" put 0.1.0-2
check "is the new version" is_version 0.1.0-2
check "keeps its data" same_data
check "keeps its settings" grep -q -- "--lang en" "$root/etc/default/kt830"
echo "take back"
check "is installed" put 0.1.0-1
check "is the old version" is_version 0.1.0-1
check "keeps its data" same_data
echo "remove"
check "is removed" within apt-get purge -y -qq kt830
for path in usr/bin/kt830 usr/lib/kt830 usr/lib/systemd/system/kt830-kiosk.service usr/lib/udev/rules.d/70-kt830.rules \
  usr/share/applications/kt830.desktop etc/default/kt830; do
  check "$path is gone" gone "$path"
done
check "keeps its data" same_data
if [[ $failed -gt 0 ]]; then echo "$failed FAILED"; exit 1; fi
echo "all good"
