#!/usr/bin/env bash
# Estimates the trajectory of the sample dive and compares it with the truth. With RECORDING=/path/to/folder-with-mav0 the
# same on a recording of yours, with all of its cameras and with the first one alone. Everything goes to demo/.
set -euo pipefail
cd "$(dirname "$0")/.."

lodeline=build/release/bin/lodeline

announce() { printf '\n== lodeline %s\n' "$*"; }

estimate() {  # FOLDER ALIGNMENT [SETTING...]
  local folder=$1 alignment=$2
  shift 2
  announce run "$recording" -o "$folder" --overwrite --draw-tracks 3 "$@"
  "$lodeline" run "$recording" -o "$folder" --overwrite --draw-tracks 3 "$@"
  [ -n "$reference" ] || return 0
  announce evaluate "$folder" "$reference" --align "$alignment" --plots "$folder/plots"
  "$lodeline" evaluate "$folder" "$reference" --align "$alignment" --interpolate --images "$recording/mav0/cam0" \
    --json "$folder/evaluation.json" --plots "$folder/plots"
}

findReference() {
  local truth=$recording/mav0/state_groundtruth_estimate0
  for reference in "$truth/data.csv" "$truth/gt_tum.txt"; do
    [ -f "$reference" ] && return 0
  done
  reference=
}

mkdir -p demo
if [ -n "${RECORDING:-}" ]; then
  recording=$RECORDING
  findReference
  estimate demo/all_cameras se3
  estimate demo/one_camera sim3 --set "source.cameras=[0]"
  results=(demo/all_cameras demo/one_camera)
else
  recording=samples/cave_dive
  findReference
  estimate demo/result yaw --mag-calibration "$recording/magnetometer.yaml" --site 20.32,-87.39,5 --date 2026-11-21
  results=(demo/result)
fi

printf '\nPictures to look at:\n'
for folder in "${results[@]}"; do
  [ -z "$reference" ] || printf '  %s\n' "$folder"/plots/*.png
  printf '  %s\n' "$folder/report.html"
  printf '  %s  tracks of one frame each 3 s, blue new to red old\n' "$folder/frames/*.png"
done
