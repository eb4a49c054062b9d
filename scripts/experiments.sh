#!/usr/bin/env bash
# Repeats the paper's experiments on replicas of its dives and writes docs/experiments.md from what was measured.
# Rendering all dives takes many hours; ended early and started again, it goes on where it was.
#
#   EXPERIMENTS=DIR  recordings in DIR/NAME_REALISM, results in DIR/results (experiments)
#   ONLY="..."       only these, e.g. "cave1_short_field cave1_long_clean" (all six)
#   RUNS=N           runs a method (3)
#   METHODS=...      (off,paper,absolute,azimuth)
#   RENDER=no        render nothing: unfinished recordings count as far as they go, absent ones are not measured
set -euo pipefail
cd "$(dirname "$0")/.."

lodeline=build/release/bin/lodeline
experiments=${EXPERIMENTS:-experiments}
document=docs/experiments.md
figures=docs/experiments
dives=(cave1_short_field cave1_long_field dos_ojos_field cave1_short_clean cave1_long_clean dos_ojos_clean)
failed=()

measure() {  # NAME_REALISM
  local dive=$1
  local arguments=("${dive%_*}" --realism "${dive##*_}" --runs "${RUNS:-3}"
    --methods "${METHODS:-off,paper,absolute,azimuth}" --recordings "$experiments" -o "$experiments/results/$dive")
  if [ "${RENDER:-yes}" = no ]; then
    [ -f "$experiments/$dive/mav0/cam0/data.csv" ] || return 0
    arguments+=(--no-rendering)
  fi
  printf '\n== lodeline compare %s\n' "${arguments[*]}"
  "$lodeline" compare "${arguments[@]}" || failed+=("$dive")
}

section() {  # NAME_REALISM
  local results=$experiments/results/$1
  if [ ! -f "$results/compare.md" ]; then
    printf '\n### %s\n\nNot measured.\n' "$1"
    return
  fi
  printf '\n'
  cat "$results/compare.md"
  for figure in trajectories relative_yaw; do
    [ -f "$results/plots/$1_$figure.png" ] || continue
    mkdir -p "$figures"
    cp "$results/plots/$1_$figure.png" "$figures/"
    printf '\n![%s](experiments/%s_%s.png)\n' "$1, ${figure/_/ }" "$1" "$figure"
  done
}

writeDocument() {
  cat docs/experiments_method.md
  printf '\n## Field: with the errors of a real rig\n'
  for dive in cave1_short_field cave1_long_field dos_ojos_field; do section "$dive"; done
  printf '\n## Clean: exact calibration, clear water\n'
  for dive in cave1_short_clean cave1_long_clean dos_ojos_clean; do section "$dive"; done
  printf '\n## COLMAP as the reference\n\n'
  if [ -f "$experiments/results/colmap.md" ]; then cat "$experiments/results/colmap.md"; else printf 'Not measured.\n'; fi
}

mkdir -p "$experiments/results"
for dive in ${ONLY:-"${dives[@]}"}; do measure "$dive"; done
writeDocument >"$document.part"
mv "$document.part" "$document"
printf '\nwrote %s\n' "$document"
[ ${#failed[@]} -eq 0 ] || { printf 'failed: %s\n' "${failed[*]}" >&2; exit 1; }
