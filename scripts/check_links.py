#!/usr/bin/env python3
"""Checks the relative links of the documentation.

Usage: scripts/check_links.py [FOLDER]

FOLDER is the project's folder; without it, the folder above this script. The script reads README.md, the other
Markdown files of that folder and all Markdown files below docs/. It checks that every linked file exists, and that
every linked heading exists in its page. Addresses on the network are not opened. It prints every dead link with file
and line, and ends with exit code 1 where there is one.
"""

import html
import re
import sys
import unicodedata
from pathlib import Path

FENCE = re.compile(r"^\s*(```|~~~)")
CODE_SPAN = re.compile(r"(`+)(?:.*?)\1")
LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
REFERENCE = re.compile(r"^\s*\[[^\]]+\]:\s*<?([^\s>]+)>?")
ATTRIBUTE = re.compile(r"(?:src|href)=\"([^\"]+)\"")
HEADING = re.compile(r"^(#{1,6})\s+(.*?)\s*#*\s*$")
EXPLICIT_ANCHOR = re.compile(r"<a\s+(?:id|name)=\"([^\"]+)\"|\{#([^}\s]+)\}")
ELSEWHERE = re.compile(r"^[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def text_lines(file):
    """Lines outside of fenced code, with their numbers; code spans are blanked."""
    fence = None
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        mark = FENCE.match(line)
        if mark and fence in (None, mark.group(1)):
            fence = None if fence else mark.group(1)
            continue
        if fence is None:
            yield number, line


def slug(heading):
    """The anchor that MkDocs gives a heading."""
    heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    heading = html.unescape(re.sub(r"[`*]", "", heading))
    heading = unicodedata.normalize("NFKD", heading).encode("ascii", "ignore").decode("ascii")
    heading = re.sub(r"[^\w\s-]", "", heading).strip().lower()
    return re.sub(r"[-\s]+", "-", heading)


def anchors(file, known={}):
    if file not in known:
        found = set()
        for _, line in text_lines(file):
            for explicit in EXPLICIT_ANCHOR.finditer(line):
                found.add(explicit.group(1) or explicit.group(2))
            heading = HEADING.match(line)
            if not heading:
                continue
            name, count = slug(heading.group(2)), 0
            while (name if count == 0 else f"{name}_{count}") in found:
                count += 1
            found.add(name if count == 0 else f"{name}_{count}")
        known[file] = found
    return known[file]


def links(file):
    for number, line in text_lines(file):
        bare = CODE_SPAN.sub(lambda code: " " * len(code.group()), line)
        for pattern in (LINK, REFERENCE, ATTRIBUTE):
            for link in pattern.finditer(bare):
                yield number, link.group(1)


def problem_of(file, target, root):
    path, _, anchor = target.partition("#")
    place = file if not path else (file.parent / path).resolve()
    if not place.exists():
        return "there is no such file"
    if root not in place.parents and place != root:
        return "leads out of the project"
    if anchor and place.suffix == ".md" and anchor not in anchors(place):
        return "the page has no such heading"
    return None


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    files = sorted(root.glob("*.md")) + sorted((root / "docs").rglob("*.md"))
    if not files:
        print(f"{root}: no Markdown files", file=sys.stderr)
        return 1
    dead = checked = 0
    for file in files:
        for number, target in links(file):
            if ELSEWHERE.match(target):
                continue
            checked += 1
            problem = problem_of(file, target, root)
            if problem:
                dead += 1
                print(f"{file.relative_to(root)}:{number}: {target}: {problem}")
    print(f"{checked} relative links in {len(files)} files, {dead} dead")
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main())
