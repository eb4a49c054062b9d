#!/usr/bin/env bash
# Repeats the paper's experiments on replicas of its dives and writes docs/lab-notes/experiments.md from what was measured.
# Rendering all dives takes many hours; ended early and started again, it goes on where it was.
#
#   EXPERIMENTS=DIR  recordings in DIR/NAME_REALISM, results in DIR/results (experiments)
#   ONLY="..."       only these, e.g. "cave1_short_field cave1_long_clean" (all six)
#   RUNS=N           runs a method (3)
#   METHODS=...      (off,paper,absolute,azimuth)
#   COLMAP=no        leave COLMAP's model out, which takes ten minutes
#   RENDER=no        render nothing: unfinished recordings count as far as they go, absent ones are not measured
set -euo pipefail
cd "$(dirname "$0")/.."

lodeline=build/release/bin/lodeline
experiments=${EXPERIMENTS:-experiments}
document=docs/lab-notes/experiments.md
figures=docs/lab-notes/experiments
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

# A model of part of the short dive, against the truth and as the reference of the runs, as the paper had it.
measureColmap() {
  local dive=cave1_short_field
  [ "${COLMAP:-yes}" = yes ] && [ -f "$experiments/results/$dive/compare.md" ] || return 0
  if ! command -v colmap >/dev/null; then
    printf '\nno COLMAP reference: Debian package colmap is not installed\n'
    return
  fi
  printf '\n== colmap_baseline.sh %s\n' "$dive"
  scripts/colmap_baseline.sh "$experiments/$dive" "$experiments/colmap" --from 30 --to 70 --every 4 \
    --runs "$experiments/results/$dive/results" --report "$experiments/results/colmap.md" || failed+=(colmap)
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

introduction() {
  cat <<'END'
# Experiments

The paper's dives, simulated with exact truth ([simulator.md](simulator.md)) and run through `lodeline compare`, whose
methods and columns [comparison.md](comparison.md) defines. This page is written by `make experiments` from what it
measured: each dive says whether it was measured in full or on which excerpt, and dives that were not measured say so.
Images are rendered once; runs differ by the noise of IMU, magnetometer and pressure sensor. The magnetometer is
calibrated from `figure_eight` with the same rig.

What the figures are held against:

| what | bar |
| --- | --- |
| `cave1_short_field`, `absolute` against `off`, rotation and position after sim(3) | the paper's gain: x0.71, x0.77 |
| `cave1_long_field`, the same | the paper's gain: x0.40, x0.23 |
| relative yaw error, `absolute`, field | at most 1°, flat over distance |
| heading against the true world, `absolute`, field | at most 0.5° RMS, and better than `azimuth` |
| clean dives, where nothing is to be gained, `absolute` against `off` | at most x1.10 |

The paper had no truth: its errors are against COLMAP (6.31° and 6.45 m without, 4.48° and 4.98 m with magnetometer on its
short dive, 14.65° and 14.57 m, 5.83° and 3.37 m on its long one). Only the gains can be compared.
END
}

writeDocument() {
  introduction
  printf '\n## Field: with the errors of a real rig\n'
  for dive in cave1_short_field cave1_long_field dos_ojos_field; do section "$dive"; done
  printf '\n## Clean: exact calibration, clear water\n'
  for dive in cave1_short_clean cave1_long_clean dos_ojos_clean; do section "$dive"; done
  printf '\n## COLMAP as the reference\n\n'
  if [ -f "$experiments/results/colmap.md" ]; then cat "$experiments/results/colmap.md"; else printf 'Not measured.\n'; fi
}

mkdir -p "$experiments/results"
for dive in ${ONLY:-"${dives[@]}"}; do measure "$dive"; done
measureColmap
writeDocument >"$document.part"
mv "$document.part" "$document"
printf '\nwrote %s\n' "$document"
[ ${#failed[@]} -eq 0 ] || { printf 'failed: %s\n' "${failed[*]}" >&2; exit 1; }
