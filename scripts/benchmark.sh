#!/usr/bin/env bash
# Runs all microbenchmarks, then times the whole program on a recording: three runs each with both cameras and
# with the left one alone. The recording is RECORDING (a folder with mav0), or EuRoC's MH_01_easy where the tests
# look for it.
set -euo pipefail
cd "$(dirname "$0")/.."

bin=build/release/bin
for benchmark in "$bin"/*_benchmark; do
  [ -x "$benchmark" ] || continue
  echo "== $(basename "$benchmark")"
  "$benchmark"
done

data=${LODELINE_DATA_DIR:-../shared/data}
recording=${RECORDING:-$data/euroc_mh01_stereo_14s}
if [ ! -d "$recording/mav0" ]; then
  echo "No recording at $recording: say where one is, make bench RECORDING=/path/to/folder-with-mav0." >&2
  exit 1
fi
output=$(mktemp -d)
trap 'rm -rf "$output"' EXIT
for cameras in '[]' '[0]'; do
  for _ in 1 2 3; do
    echo "== lodeline run $recording --set source.cameras=$cameras"
    "$bin/lodeline" run "$recording" -o "$output" --set "source.cameras=$cameras" 2>/dev/null |
      grep -E '^  (time|memory|completion)'
  done
done
