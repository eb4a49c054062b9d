#!/usr/bin/env python3
"""Compares what two builds of simd_digest print, and that all sources with wide vectors are among it.

compare_digests.py WIDE PLAIN SOURCE_FOLDER
"""

import subprocess
import sys
from pathlib import Path


def digests(program):
    output = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    return dict(line.split() for line in output.splitlines())


wide, plain = digests(sys.argv[1]), digests(sys.argv[2])
root = Path(sys.argv[3])
sources = {str(p.relative_to(root)) for p in root.rglob("*.cpp") if "\nLODELINE_WIDE_VECTORS\n" in p.read_text()}
problems = [f"{s}: not compared" for s in sorted(sources - wide.keys())]
problems += [f"{s}: AVX2 {wide[s]}, without {plain.get(s)}" for s in wide if wide[s] != plain.get(s)]
print("\n".join(problems) or f"{len(wide)} sources give the same bytes with and without AVX2")
sys.exit(1 if problems else 0)
