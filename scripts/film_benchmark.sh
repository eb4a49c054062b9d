#!/usr/bin/env bash
# Measures films: decoding alone, and a whole run, of 1080p at 30 images a second in H.264 on two cores.
#
#   FILM=FILE        a film with inertial readings, from which the measured ones are made (karma.mp4 of the test data)
#   SECONDS_USED=N   only its first N seconds (12)
#
# Two films are made of it by ffmpeg, larger and with grain: one of key and predicted images as cameras write them, and one
# with images that depend on later ones. Every second image is used. `x real time` compares with the length of the film.
set -euo pipefail
cd "$(dirname "$0")/.."

bin=build/release/bin
film=${FILM:-${LODELINE_DATA_DIR:-../shared/data}/gopro/karma.mp4}
[ -f "$film" ] || { echo "No film at $film: say where one is, make bench-film FILM=/path/to/film.mp4." >&2; exit 1; }
command -v ffmpeg >/dev/null || { echo "ffmpeg is missing: apt-get install ffmpeg" >&2; exit 1; }
output=$(mktemp -d)
trap 'rm -rf "$output"' EXIT
two_cores=(taskset --cpu-list "0,1")

# make_film NAME OPTIONS...: 1920x1080 at 45 Mbit/s with the telemetry of the film.
make_film() {
  local name=$1
  shift
  ffmpeg -v error -y -i "$film" -map 0:v:0 -map '0:d:1?' -c:d copy -copy_unknown -tag:d gpmd -t "${SECONDS_USED:-12}" \
    -vf 'scale=1920:1080:flags=lanczos,noise=alls=6:allf=t' -c:v libx264 -preset veryfast -b:v 45M -maxrate 60M -bufsize 30M "$@" \
    "$output/$name.mp4"
}
make_film camera -g 15 -bf 0
make_film reordered -g 30 -bf 2

# A guess of the camera's calibration: what a run costs is measured here, not its accuracy.
cat >"$output/rig.yaml" <<'RIG'
cam0:
  T_BS: [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
  resolution: [960, 540]
  intrinsics: [510, 510, 480, 270]
  distortion_model: none
  timeshift_cam_imu: 0.0
imu0:
  gyroscope_noise_density: 1.0e-03
  gyroscope_random_walk: 1.0e-04
  accelerometer_noise_density: 1.0e-02
  accelerometer_random_walk: 1.0e-03
RIG

figure() { sed -n "s/^ *\"$2\": \([-0-9.e+]*\),\{0,1\}$/\1/p" "$1" | head -1; }

echo "== decoding"
printf '%-34s %6s %8s %14s %16s %12s\n' film images decoded 'images/s' 'core-ms an image' 'x real time'
for name in camera reordered; do
  for width in 0 960 640; do
    for step in 1 2; do
      printf '%-34s ' "$name, width ${width/#0/1920}, every ${step/1/ } image"
      "${two_cores[@]}" "$bin/film_decoding" "$output/$name.mp4" --width "$width" --step "$step"
    done
  done
done

echo "== lodeline run, 960x540, every second image"
printf '%-10s %8s %8s %10s %10s %12s\n' film core-ms files front-end estimator 'x real time'
for name in camera reordered; do
  "${two_cores[@]}" "$bin/lodeline" run "$output/$name.mp4" --rig "$output/rig.yaml" -o "$output/run" --overwrite -q --no-report \
    --set source.image_step=2 2>/dev/null || [ $? -eq 3 ]
  run=$output/run/run.json
  printf '%-10s %8.1f %8.1f %10.1f %10.1f %12.1f\n' "$name" "$(figure "$run" total)" "$(figure "$run" files)" \
    "$(figure "$run" front_end)" "$(figure "$run" estimator)" "$(figure "$run" real_time_factor)"
done
