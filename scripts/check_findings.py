#!/usr/bin/env python3
"""Checks that docs/reference/findings.md lists every kind of finding that the sources name.

Usage: scripts/check_findings.py [FOLDER]

FOLDER is the project's folder; without it, the folder above this script. A kind is a text of lower-case letters, digits and
underscores that stands right after a severity, or a constant for such a text. Kinds that the program puts together
(`imu_gap`) are listed by their endings (`…_gap`). Kinds without a row are printed, and the exit code is 1.
"""

import re
import sys
from pathlib import Path

# After a severity: `Severity::Warning, "kind"`, perhaps with a choice of severities, harm and sensor in between.
KIND = re.compile(r"Severity::\w+(?:\s*:\s*Severity::\w+)?(?:\)\s*:\s*Severity::\w+)?,\s*"
                  r"(?:[\w.*+()\s-]+,\s*)?(?:sensor\w*,\s*|camera\.name,\s*|\"\w+\",\s*)?\"([a-z][a-z0-9_]*)\"")
WARNING = re.compile(r"\bwarn\(\"([a-z][a-z0-9_]*)\"")
CONSTANT = re.compile(r"constexpr const char\* k\w+ = \"((?:imu|camera|sensors|clocks)_[a-z_]+)\"")
ENDING = re.compile(r"(?:kind|name) \+ \"(_[a-z_]+)\"|\breport\(\s*Severity::\w+,\s*\"(_[a-z_]+)\"|claim\([^,]+,\s*\"(_[a-z_]+)\"")
NO_KIND = {"recording", "imu0", "mag0"}
OTHER_NAMES = {"comparison_figures.cpp"}  # puts together names of files, not of findings


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    page = (root / "docs" / "reference" / "findings.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"`(…?[a-z0-9_.]+)`", page))
    endings = tuple(kind[1:] for kind in listed if kind.startswith("…"))
    missing, found = {}, 0
    for folder in ("src", "apps", "ros", "python"):
        for file in sorted((root / folder).rglob("*.cpp")) + sorted((root / folder).rglob("*.h")):
            if "test" in file.name or "tests" in file.parts or file.name in OTHER_NAMES:
                continue
            source = file.read_text(encoding="utf-8")
            kinds = [match.group(1) for pattern in (KIND, WARNING, CONSTANT) for match in pattern.finditer(source)]
            kinds += ["…" + next(filter(None, match.groups())) for match in ENDING.finditer(source)]
            for kind in kinds:
                if kind in NO_KIND or kind.endswith("_"):
                    continue
                found += 1
                if kind not in listed and not kind.endswith(endings):
                    missing.setdefault(kind, file.relative_to(root))
    for kind, file in sorted(missing.items()):
        print(f"{file}: the finding {kind} has no row in docs/reference/findings.md")
    print(f"{found} places report a finding, {len(missing)} kinds are missing")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
