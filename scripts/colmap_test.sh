#!/bin/sh
# What `lodeline export --format colmap` writes, used by Debian's COLMAP: features, matches and triangulated points of one
# second of the sample dive with the poses of the run. Fails where COLMAP refuses the files, changes a pose, finds few points,
# or where its points do not fit the images.
#   scripts/colmap_test.sh PROGRAM [WORK]      exit code 77 without COLMAP
set -eu
program=$(realpath "$1")
dive=$(dirname "$(realpath "$0")")/../samples/cave_dive
command -v colmap > /dev/null || { echo "SKIPPED: colmap (Debian package colmap) is missing"; exit 77; }
work=${2:-$(mktemp -d)}
[ $# -gt 1 ] || trap 'rm -rf "$work"' EXIT
export QT_QPA_PLATFORM=offscreen
mkdir -p "$work"
cd "$work"

"$program" run "$dive" -o run --no-report --quiet
"$program" convert "$dive" part.mcap --from 10 --to 11 --quiet
"$program" convert part.mcap part --quiet
"$program" export run --format colmap --recording part -o map --quiet
cd map/colmap
log=$work/colmap.log
images=$work/part/mav0
colmap feature_extractor --database_path database.db --image_path "$images" --SiftExtraction.use_gpu 0 \
  --SiftExtraction.num_threads 2 --SiftExtraction.max_num_features 1000 > "$log" 2>&1
# In the order of names, all images of one camera come first; pairs of both cameras are found by their positions.
colmap spatial_matcher --database_path database.db --SiftMatching.use_gpu 0 --SiftMatching.num_threads 2 \
  --SpatialMatching.is_gps 0 --SpatialMatching.ignore_z 0 --SpatialMatching.max_num_neighbors 8 \
  --SpatialMatching.max_distance 1 >> "$log" 2>&1
mkdir -p triangulated text
colmap point_triangulator --database_path database.db --image_path "$images" --input_path . --output_path triangulated >> "$log" 2>&1
colmap model_converter --input_path triangulated --output_path text --output_type TXT >> "$log" 2>&1
colmap model_analyzer --path triangulated > "$work/model.txt" 2>&1

python3 - "$work" << 'EOF'
import pathlib, re, sys
work = pathlib.Path(sys.argv[1])
def poses(file):
    rows = [line.split() for line in file.read_text().splitlines() if line and not line.startswith("#")]
    return {row[9]: [float(value) for value in row[1:8]] for row in rows if len(row) == 10 and "/data/" in row[9]}
exported, kept = poses(work / "map/colmap/images.txt"), poses(work / "map/colmap/text/images.txt")
model = (work / "model.txt").read_text()
points = int(re.search(r"Points: (\d+)", model).group(1))
error_px = float(re.search(r"Mean reprojection error: ([\d.]+)px", model).group(1))
moved = max(max(abs(a - b) for a, b in zip(exported[name], pose)) for name, pose in kept.items())
print(f"{len(kept)} images of {len(exported)}, {points} points, {error_px:.2f} px, poses moved by {moved:.1g}")
sys.exit(not (len(kept) >= 0.9 * len(exported) > 15 and points > 300 and error_px < 1.5 and moved < 1e-6))
EOF
