#!/usr/bin/env python3
"""Checks the structure of the source tree; ends with exit code 1, naming each breach.

  - A folder has at most 30 files, a source file at most 400 lines.
  - Includes go downwards only. Layers are ordered by src/CMakeLists.txt, then apps, studies, ros and python; the folders inside
    a layer by the FOLDERS of its CMakeLists.txt ("." for the layer's own folder, otherwise that comes last).
  - No two headers define a class of one name in one namespace: the linker would join functions of different classes.
  - A public header (include/lodeline) counts as part of the lowest folder that uses it. It includes only public headers,
    the standard library, Eigen and OpenCV's core; so do the examples.

Tests, and helpers of tests, may include anything. Python 3 without further packages.
"""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
MOST_FILES, MOST_LINES = 30, 400
TOPS = ("include", "src", "apps", "studies", "ros", "ros2", "python", "examples", "fuzz", "web/src")
PUBLIC = "include/lodeline"
MOST_PUBLIC_HEADERS = 12
# The folder as part of which each public header counts.
FOLDER_OF_PUBLIC = {
    "version.h": "src/lodeline/util",
    "diagnostics.h": "src/lodeline/util",
    "types.h": "src/lodeline/util",
    "rig.h": "src/lodeline/sensors",
    "recording.h": "src/lodeline/io/synchronizer",
    "rosbag.h": "src/lodeline/io/rosbag",
    "estimate.h": "src/lodeline/imu",
    "trajectory.h": "src/lodeline/evaluation/trajectory",
    "odometry.h": "src/lodeline/api",
    "simulation.h": "src/simulation/sensors",
    "survey.h": "src/lodeline/output/survey/run",
    "live.h": "src/lodeline/output/live",
}


def arguments(text, keyword):
    """The words after a keyword of a CMake call, up to the next keyword."""
    match = re.search(rf"\b{keyword}\s+((?:[a-z./][\w./]*\s*)+)", text)
    return match.group(1).split() if match else []


def folders_in_order():
    """All folders of code, from the bottom up, relative to the root."""
    order = []

    def add_layer(folder):
        cmake = (ROOT / folder / "CMakeLists.txt").read_text()
        for nested in re.findall(r"add_subdirectory\(([\w./]+)\)", cmake):
            add_layer(f"{folder}/{nested}")
        order.extend(str((ROOT / folder / inside).resolve().relative_to(ROOT)) for inside in arguments(cmake, "FOLDERS"))
        if folder not in order:
            order.append(folder)

    for layer in re.findall(r"add_subdirectory\(([\w./]+)\)", (ROOT / "src/CMakeLists.txt").read_text()):
        add_layer(f"src/{layer}")
    add_layer("apps/lodeline")
    return order


def is_test(file):
    return file.name.startswith("test_") or file.stem.endswith(("_test", "_benchmark")) or "trials" in file.parts \
        or "tests" in file.parts


def target_of(include):
    if (ROOT / "include" / include).is_file():
        return FOLDER_OF_PUBLIC.get(Path(include).name)
    for top in ("src/", ""):
        if (ROOT / (top + include)).is_file():
            return str(Path(top + include).parent)
    return None


def breaches():
    rank = {folder: number for number, folder in enumerate(folders_in_order())}
    for top in TOPS:
        for folder in [ROOT / top, *(ROOT / top).rglob("*")]:
            if not folder.is_dir() or "corpus" in folder.parts:
                continue
            files = [file for file in folder.iterdir() if file.is_file()]
            if str(folder.relative_to(ROOT)) == PUBLIC and len(files) > MOST_PUBLIC_HEADERS:
                yield f"{PUBLIC}: {len(files)} headers, at most {MOST_PUBLIC_HEADERS} are allowed"
            if len(files) > MOST_FILES:
                yield f"{folder.relative_to(ROOT)}: {len(files)} files, at most {MOST_FILES} are allowed"
            for file in files:
                if file.suffix in (".h", ".cpp"):
                    yield from breaches_of(file, rank)


def breaches_of_public(name, lines):
    """Includes of a public header or an example that users do not have."""
    if str(name.parent) == PUBLIC and name.name not in FOLDER_OF_PUBLIC:
        yield f"{name}: has no folder in FOLDER_OF_PUBLIC of {Path(__file__).name}"
    for kind, include in re.findall(r'^#include ([<"])([^>"]+)[>"]', "\n".join(lines), re.M):
        is_outside = re.fullmatch(r"[a-z_]+|Eigen/\w+|opencv2/core(/\w+)?\.hpp", include)
        is_public = include.startswith("lodeline/") and (ROOT / "include" / include).is_file()
        if not (is_outside if kind == "<" else is_public):
            yield f"{name}: includes {include}, which is not for users of the library"


def breaches_of(file, rank):
    name = file.relative_to(ROOT)
    lines = file.read_text().splitlines()
    if str(name.parent) == PUBLIC or name.parts[0] == "examples":
        yield from breaches_of_public(name, lines)
    if len(lines) > MOST_LINES:
        yield f"{name}: {len(lines)} lines, at most {MOST_LINES} are allowed"
    folder = FOLDER_OF_PUBLIC.get(name.name) if str(name.parent) == PUBLIC else str(name.parent)
    own = rank.get(folder)
    if own is None:
        if name.parts[0] == "src" and not is_test(name):
            yield f"{name}: its folder is in no layer (FOLDERS of a CMakeLists.txt)"
        return
    if is_test(name):
        return
    for include in re.findall(r'^#include "([^"]+)"', "\n".join(lines), re.M):
        other = target_of(include)
        if other in rank and rank[other] > own:
            yield f"{name}: includes {include}, which is above it"


def classes_of(text):
    """Names of the classes that a header defines in its namespaces, with these."""
    text = re.sub(r"//.*", "", text)
    spaces = []
    for space, name, end in re.findall(r"^(?:namespace ([\w:]*) *\{|(?:template <.*>\n)?(?:struct|class|enum class) (\w+)"
                                       r"(?: final)?(?: *:(?!:)[^;{]*)? *\{|(\}) *\n*(?=\Z|^namespace|\}))", text, re.M):
        if name:
            yield "::".join([*spaces, name])
        elif end:
            del spaces[-1:]
        else:
            spaces.append(space)


def defined_twice():
    headers = {}
    for top in TOPS:
        for file in sorted((ROOT / top).rglob("*.h")):
            for name in classes_of(file.read_text()):
                headers.setdefault(name, []).append(str(file.relative_to(ROOT)))
    for name, files in headers.items():
        if len(files) > 1:
            yield f"{name}: a class of this name is in {' and '.join(files)}"


if __name__ == "__main__":
    found = sorted([*breaches(), *defined_twice()])
    print("\n".join(found))
    sys.exit(1 if found else 0)
