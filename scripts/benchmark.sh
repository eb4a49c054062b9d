#!/usr/bin/env bash
# Runs all microbenchmarks, then times the whole program on a recording: three runs each with both cameras and
# with the left one alone.
set -euo pipefail
cd "$(dirname "$0")/.."

bin=build/release/bin
for benchmark in "$bin"/*_benchmark; do
  [ -x "$benchmark" ] || continue
  echo "== $(basename "$benchmark")"
  "$benchmark"
done

recording=$(scripts/find-recording.sh)
output=$(mktemp -d)
trap 'rm -rf "$output"' EXIT
for cameras in '[]' '[0]'; do
  for _ in 1 2 3; do
    echo "== lodeline run $recording --set source.cameras=$cameras"
    "$bin/lodeline" run "$recording" -o "$output" --set "source.cameras=$cameras" 2>/dev/null |
      grep -E '^  (time|memory|completion)'
  done
done
