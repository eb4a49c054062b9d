#!/usr/bin/env bash
# Runs the main job on a recording, with both cameras and with the left one alone, and compares the results with
# the recording's reference. Results go to demo/.
set -euo pipefail
cd "$(dirname "$0")/.."

lodeline=build/release/bin/lodeline
recording=$(scripts/find-recording.sh)

run() {  # NAME ALIGNMENT [SETTING...]
  local name=$1 alignment=$2
  shift 2
  echo
  echo "== $name camera: lodeline run $recording -o demo/$name $*"
  "$lodeline" run "$recording" -o "demo/$name" "$@"
  [ -n "$reference" ] || return 0
  echo
  "$lodeline" evaluate "demo/$name" "$reference" --align "$alignment" --images "$recording/mav0/cam0" \
    --json "demo/$name/evaluation.json" --plots "demo/$name/plots"
}

truth=$recording/mav0/state_groundtruth_estimate0
reference=
for candidate in "$truth/data.csv" "$truth/gt_tum.txt"; do
  [ -z "$reference" ] && [ -f "$candidate" ] && reference=$candidate
done

mkdir -p demo
run stereo se3
run single sim3 --set "source.cameras=[0]"

echo
echo "Results in demo/stereo and demo/single (left camera alone):"
echo "  trajectory.tum  states.csv  landmarks.ply  config.yaml  run.json"
if [ -n "$reference" ]; then
  echo "Compared with the reference: evaluation.json, pictures in plots/, e.g. demo/stereo/plots/$(cd demo/stereo/plots && ls ./*.png | head -1 | cut -c3-)"
fi
