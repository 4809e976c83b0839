#!/usr/bin/env bash
# Fuzzes one target, or every target in turn: fuzz/run.sh [TARGET|all] [SECONDS]
# Needs cargo-fuzz (`cargo install cargo-fuzz --locked`) and a C++ compiler. What it finds is kept in fuzz/findings; the test
# `cli fuzz_corpus` reads it from then on.
set -euo pipefail
cd "$(dirname "$0")"
target=${1:-all} seconds=${2:-60}

# Files of the repository that a target begins with.
seeds_of() {
  case $1 in
    leadscrew) echo ../assets/screws ;;
    machine_description | machine_file) echo ../assets/machines ;;
    page | picture | picture_conversion | encoding) echo ../screens ;;
    part_file) echo ../assets/parts ;;
    program_check | program_lines | serial) echo ../programs ../programs/lathe ../programs/802d ../tests/nc/foreign ;;
    story) echo ../assets/stories ;;
  esac
}

if [ "$target" = all ]; then
  for file in fuzz_targets/*.rs; do "./run.sh" "$(basename "$file" .rs)" "$seconds"; done
  exit
fi
mkdir -p "corpus/$target" "findings/$target"
folders=("corpus/$target" "findings/$target")
for folder in "seeds/$target" $(seeds_of "$target"); do [ -d "$folder" ] && folders+=("$folder"); done
options=(-max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 "-artifact_prefix=findings/$target/")
[ "$target" = picture ] || options+=(-max_len=8192)
[ -f "dictionaries/$target" ] && options+=("-dict=dictionaries/$target")
cargo fuzz run --fuzz-dir . --sanitizer none "$target" "${folders[@]}" -- "${options[@]}"
