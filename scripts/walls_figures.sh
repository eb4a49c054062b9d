#!/usr/bin/env bash
# Walls of a short simulated dive, clean and as a diver delivers it, against the simulator's exact surface:
# walls_figures.sh FOLDER [METRES]
# A second call goes on where the first one ended. The dives keep their folders in FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=build/release/bin
folder=${1:-build/walls_figures}
metres=${2:-12}
dive=(--metres "$metres" --seconds "$((3 * metres))" --camera-rate-hz 6)
mkdir -p "$folder"
for realism in clean field; do
  recording=$folder/$realism
  "$bin/lodeline" simulate cave1_short "${dive[@]}" --realism "$realism" -o "$recording" --quiet
  [ -e "${recording}_run/trajectory_refined.tum" ] ||
    "$bin/lodeline" refine "$recording" -o "${recording}_run" --overwrite --quiet > "${recording}_run.txt"
  "$bin/lodeline" walls "${recording}_run" -o "${recording}_walls" --recording "$recording" --spacing 1 --overwrite --quiet
  echo "$realism:"
  "$bin/walls_study" "$recording" "${recording}_run" "${recording}_walls" "${dive[@]}" --realism "$realism"
done
