#!/usr/bin/env bash
# Paints the pictures of README and manual anew: docs/picture/make.sh [PROGRAM]
# The dressing assistant is a view that is opened by touch: its picture comes from a window.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=${1:-target/release/kt830}
[[ -x "$program" ]] || { echo "$program is missing: cargo build --release"; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

ready() { # PROGRAM
  printf '%s\n' "kind gc" "power on" "key 液压" "wait 3 s" "load $1" "home all" "key 尾座进" "wait 2 s" "key 砂轮启动" "wait 6 s" "mode auto"
}
shot() { # PAGE NAME STORY [OPTIONS]
  local page=$1 name=$2 story=$3
  shift 3
  "$program" shot "$page" --out "docs/picture/$name.png" --data "$work/data-$name" ${story:+--story "$story"} "$@"
}

{ ready O1002; printf '%s\n' "key 循环启动" "wait until idle max 120 s"; } > "$work/part"
{ ready O1002; printf '%s\n' "set #527 = 0" "key 循环启动" "wait 0.5 s" "expect alarm 3005"; } > "$work/alarm"
{ ready O1002; printf '%s\n' "scope X-actual-speed X-error output:coolant X-actual span 20 s" "key 循环启动" "wait 21 s"; } > "$work/scope"
ready O1006 > "$work/cone"
printf '%s\n' "kind gs" "power on" "key 液压" "wait 3 s" "load O1007" "home all" > "$work/surface"
printf '%s\n' "kind gc" "power on" "key 液压" "wait 3 s" "mode mdi" > "$work/line"
ready O1011 > "$work/dress"

shot grinding part "$work/part"
shot grinding cone "$work/cone"
shot grinding dressing-point "$work/dress" --size 1280x800
shot grinding grinding-en "$work/alarm" --lang en
shot alarm alarm "$work/alarm"
shot scope scope "$work/scope"
shot dressing dressing "$work/dress"
shot panel panel-gs "$work/surface" --size 1280x800
shot mdi mdi "$work/line"
shot wheel wheel "" --param P6.7=1
for page in directory diagnosis offset params; do shot "$page" "$page" ""; done

# README: a second of the film, in both languages.
for lang in zh en; do
  "$program" demo --record "$work/film-$lang" --fps 1 --lang "$lang" > /dev/null
  cp "$work/film-$lang/frame-00043.png" "docs/picture/film-$lang.png"
done
