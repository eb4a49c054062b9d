#!/usr/bin/env bash
# The paper's baseline: a COLMAP model of the images of one camera. The images are an excerpt of a recording in the
# EuRoC ASL layout. The camera is that of its sensor.yaml.
#
#   scripts/colmap_baseline.sh RECORDING OUT [--from S] [--to S] [--every N] [--runs FOLDER] [--report FILE]
#
# --from, --to  seconds after the first image (0, 40);  --every  takes one image of so many (3)
# --runs FOLDER     results of `lodeline compare` on this recording, one folder a run: each is judged against the
#                   model as well as against the truth
# --report FILE     writes the table as Markdown
#
# The model is in OUT/model, named by the images' stamps, so that `lodeline evaluate` reads it. A model that is there
# already is used again. Debian package: colmap (3.8), which nothing else here needs.
set -euo pipefail

lodeline=${LODELINE:-$(dirname "$0")/../build/release/bin/lodeline}

fail() { echo "$*" >&2; exit 1; }
usage() { sed -n '2,14s/^# \{0,1\}//p' "$0"; exit 2; }

[ $# -ge 2 ] || usage
recording=$1 out=$2
shift 2
from=0 to=40 every=3 runs= report=
while [ $# -gt 0 ]; do
  [ $# -ge 2 ] || usage
  case $1 in
    --from) from=$2 ;; --to) to=$2 ;; --every) every=$2 ;; --runs) runs=$2 ;; --report) report=$2 ;;
    *) usage ;;
  esac
  shift 2
done

camera=$recording/mav0/cam0
truth=$recording/mav0/state_groundtruth_estimate0
[ -f "$camera/data.csv" ] || fail "$camera/data.csv: missing; give a folder that contains mav0"
[ -d "$truth" ] || fail "$truth: missing; the model is judged by ground truth"
command -v colmap >/dev/null || fail "colmap is not installed: apt-get install colmap"
export QT_QPA_PLATFORM=offscreen

value() { sed -n "s/^$1: *//p" "$camera/sensor.yaml" | sed 's/#.*//' | tr -d '[] \r'; }

# COLMAP counts pixels from the corner of the first one, Lodeline from its centre.
cameraModel() {
  case $(value distortion_model) in
    radial-tangential | radtan) model=OPENCV ;;
    equidistant) model=OPENCV_FISHEYE ;;
    none | '') model=PINHOLE ;;
    *) fail "$camera/sensor.yaml: no COLMAP model for distortion $(value distortion_model)" ;;
  esac
  parameters=$(value intrinsics | awk -F, '{printf "%s,%s,%.9g,%.9g", $1, $2, $3 + 0.5, $4 + 0.5}')
  [ "$model" = PINHOLE ] || parameters=$parameters,$(value distortion_coefficients | cut -d, -f1-4)
}

selectImages() {
  mkdir -p "$out/images"
  awk -F, -v from="$from" -v to="$to" -v every="$every" '
    /^#/ { next }
    { gsub(/[ \r]/, ""); if (!first) first = $1; s = ($1 - first) / 1e9 }
    s >= from && s <= to && n++ % every == 0 { print $1, ($2 == "" ? $1 ".png" : $2) }' "$camera/data.csv" |
    while read -r stamp name; do
      [ ! -f "$camera/data/$name" ] || ln -sf "$(realpath "$camera/data/$name")" "$out/images/$stamp.${name##*.}"
    done
  images=$(find "$out/images" -type l | wc -l)
  [ "$images" -ge 10 ] || fail "$camera: only $images images from $from s to $to s"
}

reconstruct() {
  cameraModel
  rm -rf "$out/images" "$out/database.db" "$out/sparse" "$out/model" "$out/model_text"
  selectImages
  colmap feature_extractor --database_path "$out/database.db" --image_path "$out/images" \
    --ImageReader.single_camera 1 --ImageReader.camera_model "$model" --ImageReader.camera_params "$parameters" \
    --SiftExtraction.use_gpu 0 --SiftExtraction.max_num_features 2048 >"$out/colmap.log" 2>&1
  colmap sequential_matcher --database_path "$out/database.db" --SiftMatching.use_gpu 0 \
    --SequentialMatching.overlap 8 >>"$out/colmap.log" 2>&1
  mkdir -p "$out/sparse"
  colmap mapper --database_path "$out/database.db" --image_path "$out/images" --output_path "$out/sparse" \
    --Mapper.ba_refine_focal_length 0 --Mapper.ba_refine_principal_point 0 --Mapper.ba_refine_extra_params 0 \
    >>"$out/colmap.log" 2>&1
  # Where it fell into parts, the largest.
  best=$(ls -S "$out"/sparse/*/images.bin 2>/dev/null | head -n 1)
  [ -n "$best" ] || fail "COLMAP found no model; $out/colmap.log says more"
  parts=$(ls -d "$out"/sparse/*/ | wc -l)
  printf '%s s to %s s, every %s. image: %s images, %s part(s)\n' "$from" "$to" "$every" "$images" "$parts" \
    >"$out/excerpt.txt"
  mv "$(dirname "$best")" "$out/model"
  mkdir -p "$out/model_text"
  colmap model_converter --input_path "$out/model" --output_path "$out/model_text" --output_type TXT >>"$out/colmap.log" 2>&1
}

# NAME ESTIMATE REFERENCE OPTIONS...: a row with RMSE of rotation and position, scale and number of poses. A model has
# a unit of length of its own: errors against one are given in metres of the estimate.
judge() {
  local name=$1 estimate=$2 reference=$3 own_unit=0
  shift 3
  [ "$reference" != "$out/model" ] || own_unit=1
  "$lodeline" evaluate "$estimate" "$reference" --align sim3 "$@" | awk -v name="$name" -v own_unit="$own_unit" '
    /^pairs/ { pairs = $2 }
    /^alignment/ { sub(/.*scale /, ""); scale = $1 }
    /^  position \(m\)/ && position == "" { position = $3 }
    /^  rotation \(deg\)/ && rotation == "" { rotation = $3 }
    END { if (own_unit) position /= scale
      printf "| %s | %.2f° | %.3f m | %.4f | %d |\n", name, rotation, position, scale, pairs }'
}

# The poses of a run at the images that the model has a pose for.
cutRun() {
  awk '
    FNR == NR { if ($NF ~ /^[0-9]+\.[a-z]+$/) { sub(/\..*/, "", $NF); wanted[substr($NF, 1, length($NF) - 6)] } next }
    /^#/ { next }
    { sub(/\./, "", $1); key = substr($1, 1, length($1) - 6) }
    key in wanted { sub(/.........$/, ".&", $1); print }' "$out/model_text/images.txt" "$1/trajectory.tum" >"$out/excerpt.tum"
}

table() {
  local body=(--body-from-camera "$camera/sensor.yaml")
  printf 'COLMAP 3.8, one camera, fixed intrinsics, sequential matching, %s.\n\n' "$(cat "$out/excerpt.txt")"
  printf '| estimate, after sim(3) alignment | rotation | position | scale | poses |\n| --- | --- | --- | --- | --- |\n'
  judge 'COLMAP against the truth' "$out/model" "$truth" "${body[@]}"
  [ -n "$runs" ] || return 0
  for run in "$runs"/*/; do
    [ -f "$run/trajectory.tum" ] || continue
    cutRun "$run"
    judge "\`$(basename "$run")\` against COLMAP" "$out/excerpt.tum" "$out/model" "${body[@]}"
    judge "\`$(basename "$run")\` against the truth" "$out/excerpt.tum" "$truth"
  done
}

mkdir -p "$out"
[ -f "$out/model/images.bin" ] || reconstruct
if [ -n "$report" ]; then table | tee "$report"; else table; fi
