#!/usr/bin/env bash
# The fault campaign on the real recording and on a simulated dive: faults.sh OUTPUT [options of fault_campaign/run.py]
# RECORDING: a stereo recording with truth (default: EuRoC's in the folder of test data). Without it, ends with 77.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
lodeline=$root/build/release/bin/lodeline
output=$1
shift
recording=${RECORDING:-${LODELINE_DATA_DIR:-$root/../shared/data}/euroc_mh01_stereo_14s}
[ -d "$recording/mav0" ] || { echo "SKIPPED: no recording at $recording"; exit 77; }
mkdir -p "$output"
data=(--data "$recording")
if [ "${SIMULATED:-yes}" = yes ]; then
  dive=$output/simulated_dive
  [ -d "$dive/mav0" ] || "$lodeline" simulate demo --realism field --seconds 8 --width 400 --starts-moving --quiet -o "$dive"
  data+=(--data "$dive")
fi
exec python3 "$root/scripts/fault_campaign/run.py" --program "$lodeline" "${data[@]}" --work "$output/work" "$@"
