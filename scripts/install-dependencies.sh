#!/usr/bin/env bash
# Installs what Lodeline needs on Debian 12 or Ubuntu 24.04:
# install-dependencies.sh [build|test|ros|dds|web|docs|fleet ...]
#   build  compiler, libraries and the page's bundler: all that `make build` needs (default)
#   test   what the tests need: those, their framework, Clang, the formatter, survey and GIS programs, a browser
#   ros    the ROS 1 node, and bags written by `lodeline convert`
#   dds    lodeline_dds, for networks of ROS 2
#   web    the browser that the page is tested in
#   docs   the tools of `make docs`
#   fleet  the schedulers of `make fleet-test`
# Does nothing where all of it is present.
set -euo pipefail

build=(
  build-essential cmake ninja-build ccache git
  libboost-dev libeigen3-dev libceres-dev libgoogle-glog-dev libyaml-cpp-dev libcli11-dev libfmt-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libopencv-calib3d-dev libopencv-video-dev
  libopencv-features2d-dev libsqlite3-dev
  nlohmann-json3-dev zlib1g-dev libdeflate-dev
  libapriltag-dev  # boards for the calibration of cameras
  libgeographiclib-dev libproj-dev libxml2-dev libnanoflann-dev libembree-dev libtbb-dev
  libbz2-dev liblz4-dev libzstd-dev  # ROS bags
  libavformat-dev libavcodec-dev libswscale-dev libavutil-dev  # films
  gnuplot-nox
  libcpp-httplib-dev
  pybind11-dev python3-dev python3-numpy  # the Python module
)
# The report page. A node from elsewhere clashes with Debian's. npm as a package brings 360 others along; without one, CMake
# fetches npm as one file.
command -v node >/dev/null || build+=(nodejs ca-certificates)
ros=(
  librosbag-storage-dev libsensor-msgs-dev  # writing bags
  libroscpp-dev libnav-msgs-dev libgeometry-msgs-dev libtf2-msgs-dev libdiagnostic-msgs-dev  # the ROS 1 node
)
# Ubuntu has newer versions under other names.
dds=()
grep -q '^ID=debian' /etc/os-release && dds=(libfastrtps-dev libfastcdr-dev)
test=(
  "${build[@]}"
  libgtest-dev libgmock-dev libbenchmark-dev python3
  clang-format-14  # other versions lay code out differently
  clang-14 libclang-rt-14-dev  # the sanitized build and its fuzzers
  lld  # links a hundred programs in a fifth of the time
  clang-tidy-14 gcovr  # `make tidy`, `make coverage`
  libopen3d-dev  # `lodeline walls`; `make build` leaves its surfaces out without it
  libgdal-dev  # GeoPackage and DXF by `export`; `make build` leaves them out without it
  survex therion gdal-bin proj-bin libxml2-utils  # tests ask these whether they understand what `export` writes
  "${ros[@]}"
  "${dds[@]}"
  python3-matplotlib  # examples of the Python module
  python3-roslaunch  # roscore, for the node's test
  python3-rosbag python3-sensor-msgs python3-geometry-msgs python3-nav-msgs  # bags by another program
)
# For the page's tests; Ubuntu has no such package.
browser=()
grep -q '^ID=debian' /etc/os-release && browser=(chromium)
test+=("${browser[@]}")
web=("${browser[@]}")
fleet=(slurm-wlm munge snakemake procps)
docs=(mkdocs-material doxygen libjs-katex python3)

packages=()
for group in "${@:-build}"; do
  case $group in
    build | test | ros | dds | web | docs | fleet) declare -n chosen=$group && packages+=("${chosen[@]}") ;;
    *) echo "unknown group '$group'; groups are build, test, ros, dds, web, docs and fleet" >&2 && exit 2 ;;
  esac
done

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
