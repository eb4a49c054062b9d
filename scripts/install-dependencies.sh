#!/usr/bin/env bash
# Installs what Lodeline needs on Debian 12 or Ubuntu 24.04. Does nothing where all of it is present.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache git
  clang-format-14  # other versions lay code out differently
  libboost-dev libeigen3-dev libceres-dev libgoogle-glog-dev libopencv-dev libyaml-cpp-dev libcli11-dev libfmt-dev
  nlohmann-json3-dev zlib1g-dev libdeflate-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  libgeographiclib-dev libproj-dev libxml2-dev libnanoflann-dev libembree-dev libtbb-dev
  libbz2-dev liblz4-dev librosbag-storage-dev libsensor-msgs-dev  # ROS 1 bags
  libroscpp-dev libnav-msgs-dev libgeometry-msgs-dev libtf2-msgs-dev libdiagnostic-msgs-dev  # the ROS 1 node
  python3-roslaunch  # roscore, for the node's test
  python3-rosbag python3-sensor-msgs python3-geometry-msgs  # bags by another program, for the tests
  clang-14 libclang-rt-14-dev  # the sanitized build and its fuzzers
  gnuplot-nox
  libcpp-httplib-dev
  survex therion gdal-bin libxml2-utils  # tests ask these whether they understand what `export` writes
)

# The report page. A node from elsewhere brings its own npm, and Debian's would clash with it.
command -v npm >/dev/null || packages+=(nodejs npm)
# For the page's tests; Ubuntu has no such package.
grep -q '^ID=debian' /etc/os-release && packages+=(chromium)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

sudo=
if [ "$(id -u)" -ne 0 ]; then
  sudo=sudo
  command -v sudo >/dev/null || { echo "Missing packages; install as root: apt-get install ${missing[*]}" >&2; exit 1; }
fi
echo "Installing: ${missing[*]}"
$sudo apt-get update -qq
$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
