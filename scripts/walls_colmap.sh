#!/usr/bin/env bash
# Walls by Lodeline and points by COLMAP (Debian's, without CUDA: sparse points) of an excerpt of a simulated dive,
# both with the poses of the run, against the simulator's exact surface:
#   walls_colmap.sh FOLDER [FROM] [TO]     seconds of the run (6, 11); FOLDER as of walls_figures.sh, which runs first
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$PWD/build/release/bin
folder=$(realpath "${1:-build/walls_figures}")
from=${2:-6}
to=${3:-11}
command -v colmap > /dev/null || { echo "colmap (Debian package colmap) is missing" >&2; exit 1; }
[ -e "$folder/clean_run/trajectory_refined.tum" ] || { echo "$folder: run walls_figures.sh first" >&2; exit 1; }
export QT_QPA_PLATFORM=offscreen
dive=(--metres 12 --seconds 36 --camera-rate-hz 6 --realism clean --from "$from" --to "$to")
work=$folder/colmap
images=$work/part/mav0
rm -rf "$work"
mkdir -p "$work/triangulated" "$work/text"

"$bin/lodeline" walls "$folder/clean_run" -o "$work/walls" --recording "$folder/clean" --from "$from" --to "$to" --quiet
"$bin/lodeline" convert "$folder/clean" "$work/part.mcap" --from "$from" --to "$to" --quiet
"$bin/lodeline" convert "$work/part.mcap" "$work/part" --quiet
"$bin/lodeline" export "$folder/clean_run" --format colmap --recording "$work/part" -o "$work/map" --quiet
cd "$work/map/colmap"
{
  colmap feature_extractor --database_path database.db --image_path "$images" --SiftExtraction.use_gpu 0 \
    --SiftExtraction.num_threads 2 --SiftExtraction.max_num_features 3000
  colmap spatial_matcher --database_path database.db --SiftMatching.use_gpu 0 --SiftMatching.num_threads 2 \
    --SpatialMatching.is_gps 0 --SpatialMatching.ignore_z 0 --SpatialMatching.max_num_neighbors 8 \
    --SpatialMatching.max_distance 2
  colmap point_triangulator --database_path database.db --image_path "$images" --input_path . --output_path "$work/triangulated"
  colmap model_converter --input_path "$work/triangulated" --output_path "$work/text" --output_type TXT
} > "$work/colmap.log" 2>&1
echo "COLMAP, $(grep -vc '^#' "$work/text/points3D.txt") points of $(find "$images" -name '*.png' | wc -l) images:"
"$bin/walls_study" "$folder/clean" "$folder/clean_run" "$work/text/points3D.txt" "${dive[@]}"
echo "Lodeline:"
"$bin/walls_study" "$folder/clean" "$folder/clean_run" "$work/walls" "${dive[@]}"
