# Shared by the experiments with Slurm and Snakemake. Sourced, not run.

lodeline=${LODELINE:-$(command -v lodeline || true)}
[ -x "$lodeline" ] || { echo "name the program: LODELINE=/path/to/lodeline" >&2; exit 2; }
lodeline=$(realpath "$lodeline")

# prepare_fleet NAME ITEMS DIVES: a list of so many runs of so many short dives in small images. The folder is $work.
prepare_fleet() {
  work=${WORK:-$(mktemp -d "/tmp/lodeline_$1.XXXXXX")}
  mkdir -p "$work"
  work=$(cd "$work" && pwd)
  {
    echo 'args: [--no-report]'
    echo 'recordings:'
    echo '  - {name: dive, simulate: open_water --seconds 3 --starts-moving --width 160 --camera-rate-hz 10 --threads 1}'
    echo "seeds: [$(seq -s, "$3")]"
    echo 'variants:'
    for variant in $(seq $(($2 / $3))); do echo "  - {name: v$variant, set: {front_end.seed: $variant}}"; done
  } > "$work/list.yaml"
  started_s=$(date +%s)
  echo "$2 runs of $3 dives in $work"
}

# Number of runs that are finished, with or without success.
results() { find "$work/out/results" "$work/out/failed" -mindepth 1 -maxdepth 1 2>/dev/null | wc -l; }

# The processes that work on the batch, without their runs.
workers() { pgrep -f "^$lodeline batch $work/list.yaml" || true; }

# kill_worker: takes one of them away at once, and its runs with it.
kill_worker() {
  local pid
  pid=$(workers | shuf -n 1)
  [ -n "$pid" ] && kill -KILL "$pid" && echo "killed worker $pid at $(results) results"
}

# check_fleet ITEMS: one result an item, and nothing made twice by the workers' own records.
check_fleet() {
  "$lodeline" batch "$work/list.yaml" -o "$work/out" --summary --quiet || [ $? -eq 1 ]
  local left
  left=$(find "$work/out/.locks" "$work/out/.work" -mindepth 1 2>/dev/null | wc -l)
  cat "$work"/out/workers/*.csv | sort -t, -n -k1,1 | awk -F, -v items="$1" -v results="$(results)" -v left="$left" \
    -v seconds="$(($(date +%s) - started_s))" '
      $3 == "started" { started++; if ($2 in done) { late++; print "made again: " $2 } }
      $3 == "failed" { failed++ }
      $3 == "done" || $3 == "failed" { if ($2 in done) { twice++; print "made twice: " $2 } done[$2] }
      END {
        for (item in done) finished++
        printf "%d items, %d results (%d without a trajectory), %d recorded by their workers, ", items, results, failed, finished
        printf "%d runs started, %d cut off, %d made twice, ", started, started - finished, twice + late
        printf "%d locks and unfinished folders left, %d s\n", left, seconds
        exit !(results == items && twice + late == 0 && left == 0)
      }'
}
