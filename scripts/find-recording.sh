#!/usr/bin/env bash
# Prints the folder of the recording that the demonstration and the benchmark run on, or says what to download.
set -euo pipefail
cd "$(dirname "$0")/.."

data=${LODELINE_DATA_DIR:-../shared/data}
for recording in ${RECORDING:+"$RECORDING"} "$data/euroc_mh01_stereo_14s" "$data/MH_01_easy"; do
  if [ -d "$recording/mav0/cam0" ] && [ -d "$recording/mav0/imu0" ]; then
    realpath --relative-to=. "$recording"
    exit 0
  fi
done

cat >&2 <<MESSAGE
No recording found. Looked for ${RECORDING:+$RECORDING, }$data/euroc_mh01_stereo_14s and $data/MH_01_easy.

Download MH_01_easy in the ASL Dataset Format (1.5 GB) of the EuRoC MAV dataset, ETH Zurich:
  https://projects.asl.ethz.ch/datasets/doku.php?id=kmavvisualinertialdatasets
unpack it so that a folder MH_01_easy contains mav0, and say where it is:
  make demo RECORDING=/path/to/MH_01_easy
MESSAGE
exit 1
