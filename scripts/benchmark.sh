#!/usr/bin/env bash
# Runs all microbenchmarks, then measures the whole program on a recording: processor time of a frame by stage, ratio
# to real time and memory, with all cameras and with the first alone; what opening the page of a long dive takes;
# last, memory and cost over a long dive.
#
#   RECORDING=DIR    a folder with mav0 (EuRoC's MH_01_easy where the tests look for it)
#   SECONDS_USED=N   only its first N seconds of images (all)
#   RUNS=N           runs, of which the one of median cost is shown (3)
#   DIVE_MINUTES=N   length of the long dive, the recording played to and fro (50; 0: none)
#   MICRO=no         leave the microbenchmarks out
set -euo pipefail
cd "$(dirname "$0")/.."

bin=build/release/bin
recording=${RECORDING:-${LODELINE_DATA_DIR:-../shared/data}/euroc_mh01_stereo_14s}
minutes=${DIVE_MINUTES:-50}
if [ ! -d "$recording/mav0" ]; then
  echo "No recording at $recording: say where one is, make bench RECORDING=/path/to/folder-with-mav0." >&2
  exit 1
fi
output=$(mktemp -d)
trap 'rm -rf "$output"' EXIT

# figure FILE NAME: the first number of that name in a run.json
figure() { sed -n "s/^ *\"$2\": \([-0-9.e+]*\),\{0,1\}$/\1/p" "$1" | head -1; }

# measure NAME DATA ARGUMENTS...: one line of figures of the run of median cost
measure() {
  local name=$1 data=$2 run
  shift 2
  for run in $(seq "${RUNS:-3}"); do
    "$bin/lodeline" run "$data" -o "$output/run" --overwrite -q --no-report --set "source.duration_s=${SECONDS_USED:-0}" "$@" \
      2>/dev/null
    cp "$output/run/run.json" "$output/$run.json"
    echo "$(figure "$output/$run.json" total) $output/$run.json"
  done | sort -n | awk '{ line[NR] = $2 } END { print line[int((NR + 1) / 2)] }' >"$output/median"
  print_figures "$name" "$(cat "$output/median")"
}

print_figures() {
  printf '%-12s %7.1f %7.1f %10.1f %10.1f %12.1f %10.0f %8.0f\n' "$1" "$(figure "$2" total)" "$(figure "$2" files)" \
    "$(figure "$2" front_end)" "$(figure "$2" estimator)" "$(figure "$2" real_time_factor)" \
    "$(figure "$2" peak_memory_MB)" "$(figure "$2" frames)"
}

# to_and_fro DATA COPY MINUTES BIASES: DATA's images and inertial readings forward and backward in turn. Backward, a
# gyroscope reads the opposite rate plus its bias, an accelerometer the same.
to_and_fro() {
  local sensor from
  mkdir -p "$2/mav0"
  # body.yaml and the like stand beside the sensors.
  find "$1/mav0" -maxdepth 1 -type f -exec cp {} "$2/mav0/" \;
  for from in "$1"/mav0/cam* "$1/mav0/imu0"; do
    sensor=$2/mav0/$(basename "$from")
    mkdir -p "$sensor"
    find "$from" -maxdepth 1 -type f ! -name data.csv -exec cp {} "$sensor/" \;
    [ ! -d "$from/data" ] || ln -s "$(realpath "$from/data")" "$sensor/data"
    awk -F, -v OFS=, -v minutes="$3" -v biases="$4" -v inertial="$([ -d "$from/data" ] || echo 1)" \
      -v begin="$(sed -n 2p "$1/mav0/cam0/data.csv" | cut -d, -f1)" \
      -v end="$(tail -1 "$1/mav0/cam0/data.csv" | cut -d, -f1)" '
      # Stamps have more digits than awk counts with: seconds and nanoseconds apart.
      function since(stamp, origin,  s) {
        s = substr(stamp, 1, length(stamp) - 9) - substr(origin, 1, length(origin) - 9)
        return s * 1e9 + substr(stamp, length(stamp) - 8) - substr(origin, length(origin) - 8)
      }
      function stamp(ns,  s) {
        s = int(ns / 1e9)
        return sprintf("%d%09d", 1000 + s, ns - s * 1e9)
      }
      BEGIN { split(biases, bias, ","); length_ns = since(end, begin) }
      /^#/ { print; next }
      { t = since($1, begin); if (t >= 0 && t < length_ns) { ++n; time[n] = t; sub(/^[^,]*,/, ""); rest[n] = $0 } }
      END {
        for (pass = 0; pass * length_ns < minutes * 60e9; ++pass) {
          backward = pass % 2
          for (k = 1; k <= n; ++k) {
            i = backward ? n + 1 - k : k
            t = pass * length_ns + (backward ? length_ns - time[i] : time[i])
            line = rest[i]
            if (backward && inertial) {
              split(rest[i], f, ",")
              line = 2 * bias[1] - f[1] "," 2 * bias[2] - f[2] "," 2 * bias[3] - f[3] "," f[4] "," f[5] "," f[6]
            }
            print stamp(t) "," line
          }
        }
      }' "$from/data.csv" >"$sensor/data.csv"
  done
}

if [ "${MICRO:-yes}" != no ]; then
  for benchmark in "$bin"/*_benchmark; do
    [ -x "$benchmark" ] || continue
    echo "== $(basename "$benchmark")"
    "$benchmark"
  done
fi

echo "== lodeline run $recording"
header=$(printf '%-12s %7s %7s %10s %10s %12s %10s %8s' cameras core-ms files front-end estimator 'x real time' 'memory MB' frames)
echo "$header"
measure all "$recording"
measure 'first alone' "$recording" --set 'source.cameras=[0]'

if [ -x "$bin/page_browser_test" ]; then
  echo "== the page of a 50-minute dive"
  "$bin/page_browser_test" --gtest_filter='*FiftyMinutes*' --gtest_brief=1
fi

[ "$minutes" != 0 ] || exit 0
echo "== the same to and fro for $minutes minutes"
"$bin/lodeline" run "$recording" -o "$output/run" --overwrite -q --no-report 2>/dev/null
to_and_fro "$recording" "$output/dive" "$minutes" "$(tail -1 "$output/run/states.csv" | cut -d, -f17-19)"
frames=$(grep -vc '^#' "$output/dive/mav0/cam0/data.csv")
"$bin/lodeline" run "$output/dive" -o "$output/long" --overwrite -q --no-report 2>/dev/null &
process=$!
echo 'progress  memory now'
for tenth in 1 2 3 4 5 6 7 8 9; do
  while kill -0 "$process" 2>/dev/null &&
    [ "$(wc -l 2>/dev/null <"$output/long/states.csv" || echo 0)" -lt $((frames * tenth / 10)) ]; do
    sleep 0.5
  done
  memory=$(awk '/^VmRSS/ { printf "%.0f MB", $2 * 1.024e-3 }' "/proc/$process/status" 2>/dev/null || true)
  printf '%7d %%  %s\n' $((10 * tenth)) "$memory"
done
wait "$process"
echo "$header"
print_figures 'all' "$output/long/run.json"
