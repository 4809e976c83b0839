#!/usr/bin/env bash
# What the scripts that look at a real window need; they source it.

# Ends the script, saying that nothing was tested, if one of the commands is missing: NAME COMMAND...
need() {
  local name=$1 command
  for command in "${@:2}"; do
    if ! command -v "$command" >/dev/null; then
      echo "$name: '$command' is missing; NOTHING was tested"
      exit 0
    fi
  done
}

# Sets `program`: the built one that KT830_WINDOW_PROGRAM names, or one that is built now.
find_program() {
  program=${KT830_WINDOW_PROGRAM:-}
  if [[ -z "$program" ]]; then
    cargo build --locked
    program=${CARGO_TARGET_DIR:-target}/debug/kt830
  fi
}
