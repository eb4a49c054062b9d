"""Runs a list by `lodeline batch`, for the scripts beside this file."""

import csv
import json
import subprocess
import sys


def run_batch(program, work, listed, jobs):
    """Makes the runs of a list that are missing, with WORK as the output. Returns the rows of the batch's table by item."""
    work.mkdir(parents=True, exist_ok=True)
    file = work / "list.yaml"
    file.write_text(json.dumps(listed, indent=1), encoding="utf-8")
    command = [program, "batch", file, "-o", work, "--jobs", jobs]
    exit_code = subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL).returncode
    if exit_code not in (0, 1):  # 1: some items failed, which the table says
        sys.exit(f"{' '.join(map(str, command))}: exit code {exit_code}")
    with (work / "table.csv").open(encoding="utf-8") as table:
        return {row["name"]: row for row in csv.DictReader(table)}
