#!/usr/bin/env bash
# Unpacks the Debian packages of a folder below a temporary root, and runs the program and the Python module from there:
# check_packages.sh [FOLDER]
# Their dependencies must name every library that they load, and must be there on this system. `make package` calls it.
set -euo pipefail

sample=$(realpath "$(dirname "$0")/../samples/cave_dive")
cd "${1:-build/release}"
program=(lodeline_*.deb) module=(python3-lodeline_*.deb)
[ -e "${module[0]}" ] || module=()
packages=("${program[@]}" "${module[@]}")
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

fail() { echo "check_packages.sh: $*" >&2 && exit 1; }

[[ ${#program[@]} -eq 1 && -e ${program[0]} ]] || fail "one file lodeline_*.deb is expected in $PWD"
[ ${#module[@]} -le 1 ] || fail "several files python3-lodeline_*.deb are in $PWD"
for package in "${packages[@]}"; do
  dpkg-deb --extract "$package" "$root"
done
doubled=$(for package in "${packages[@]}"; do dpkg-deb --contents "$package"; done | awk '$1 !~ /^d/ {print $6}' | sort | uniq -d)
[ -z "$doubled" ] || fail "several packages have $doubled"

# Whether the dependencies of a package name the packages of all libraries that one of its files loads.
check_libraries() {
  local depends owners library
  depends=$(dpkg-deb --field "$1" Depends | sed 's/[,|]/\n/g' | sed 's/^ *//; s/ .*//; s/:.*//')
  for library in $(objdump -p "$2" | awk '$1 == "NEEDED" {print $2}'); do
    owners=$(dpkg-query --search "*/$library" | sed 's/:.*//') || fail "no package has $library"
    grep -qxF "$owners" <<<"$depends" || fail "$1: lacks the dependency on ${owners//$'\n'/ or } for $library"
  done
}
check_libraries "${program[0]}" "$root/usr/bin/lodeline"

# Nothing is installed here.
apt-get install --simulate --no-install-recommends --quiet=2 "${packages[@]/#/./}" >"$root/apt" 2>&1 ||
  fail "dependencies that cannot be installed: $(cat "$root/apt")"

work=$root/work
mkdir "$work" && cd "$work"
part=(--set source.duration_s=4)
"$root/usr/bin/lodeline" run "$sample" -o by_program "${part[@]}" --no-report --quiet
[ -s by_program/trajectory.tum ] || fail "${program[0]}: lodeline run writes no trajectory"

if [ ${#module[@]} -eq 1 ]; then
  packages_of_python=$(dirname "$(find "$root/usr/lib" -path '*/dist-packages/lodeline')")
  check_libraries "$OLDPWD/${module[0]}" "$packages_of_python"/lodeline/_lodeline*.so
  for file in __init__.py _lodeline.pyi _feed.pyi py.typed; do
    [ -e "$packages_of_python/lodeline/$file" ] || fail "${module[0]}: lacks $file"
  done
  /usr/bin/python3 -c "import site, sys; sys.exit('${packages_of_python#"$root"}' not in site.getsitepackages())" ||
    fail "${module[0]}: Python does not look in ${packages_of_python#"$root"}"
  export PYTHONPATH=$packages_of_python PYTHONDONTWRITEBYTECODE=1
  /usr/bin/python3 - "$sample" "$root" <<'PYTHON'
import sys
import lodeline

sample, root = sys.argv[1:]
assert lodeline.__file__.startswith(root), lodeline.__file__
undescribed = [name for name in lodeline.__all__ if not getattr(lodeline, name).__doc__ and not name.startswith("__")]
assert not undescribed, undescribed
lodeline.run(sample, "by_module", settings={"source.duration_s": 4})
PYTHON
  cmp by_program/trajectory.tum by_module/trajectory.tum || fail "${module[0]}: another trajectory than the program's"
  /usr/bin/python3 "$root/usr/share/doc/python3-lodeline/examples/1_run_recording.py" "$sample" by_example 2 >/dev/null 2>&1
fi
echo "packages are good: ${packages[*]}"
