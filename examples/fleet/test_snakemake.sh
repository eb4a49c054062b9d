#!/usr/bin/env bash
# Runs short simulated dives by Snakemake, kills workers in between, and checks that each run has one result and none was
# made twice. A long experiment (make fleet-test):
#   LODELINE=build/release/bin/lodeline test_snakemake.sh [ITEMS [DIVES [KILLS]]]
# It needs Debian's snakemake. WORK names its folder, CORES the number of workers.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/test_common.sh"
items=${1:-200}
dives=${2:-$items}
kills=${3:-20}
prepare_fleet snakemake "$items" "$dives"
cd "$work"
snakemake -s "$here/Snakefile" --cores "${CORES:-$(nproc)}" --restart-times "$kills" --quiet --nocolor \
  --config list="$work/list.yaml" out="$work/out" shards=8 lodeline="$lodeline" > "$work/snakemake.log" 2>&1 &
snakemake=$!
# On SIGTERM Snakemake waits for its workers, which would go on.
trap 'kill "$snakemake" $(workers) 2>/dev/null || true' EXIT
for kill in $(seq "$kills"); do
  while [ "$(results)" -lt $((items * kill / (kills + 1))) ] || [ -z "$(workers)" ]; do
    kill -0 "$snakemake" 2>/dev/null || break
    sleep 0.2
  done
  kill_worker || true
done
wait "$snakemake" || { tail -n 20 "$work/snakemake.log" >&2; exit 1; }
trap - EXIT
check_fleet "$items"
