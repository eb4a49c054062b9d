#!/usr/bin/env python3
"""Moves the declarations that users of the library need to include/lodeline, and changes every include of them.

A public header consists of whole headers of the layers, which are removed, and of types out of others. Run it in a
tree without changes; the outcome depends on the tree alone. Needs clang-format-14.
"""
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TOPS = ("src", "apps", "studies", "examples", "ros", "fuzz", "include")
# Parts of each public header in order: a header, or header:Type for one type and its toString().
PARTS = {
    "diagnostics.h": ["lodeline/util/error.h", "lodeline/util/diagnostics.h"],
    "types.h": ["lodeline/util/time/time.h", "lodeline/geometry/types.h", "lodeline/geometry/rigid3.h",
                "lodeline/magnetometer/earth_field/world_magnetic_model.h:GeodeticPosition"],
    "rig.h": ["lodeline/sensors/measurements.h", "lodeline/sensors/rig.h", "lodeline/sensors/imu_correction.h"],
    "recording.h": ["lodeline/io/synchronizer/measurement_source.h", "lodeline/io/synchronizer/live_source.h",
                    "lodeline/io/euroc/euroc_rig.h:EurocOptions"],
    "estimate.h": ["lodeline/imu/propagation.h:NavigationState", "lodeline/imu/inertial_doubt.h",
                   "lodeline/imu/preintegration.h:SensorAxes", "lodeline/frontend/tracking/tracks.h:TrackId",
                   "lodeline/estimator/state/window.h:MapPoint", "lodeline/estimator/estimator.h:Status",
                   "lodeline/estimator/mode/mode_machine.h:Mode",
                   "lodeline/estimator/state/camera_states.h:CameraCorrections",
                   "lodeline/estimator/options/magnetometer_options.h:HeadingReference",
                   "lodeline/estimator/magnetometer/field/magnetometer_gate.h:MagnetometerStatus",
                   "lodeline/estimator/magnetometer/magnetometer_fusion.h:MagnetometerEstimate",
                   "lodeline/estimator/state/parameter_block.h:ScalarPrior",
                   "lodeline/estimator/pressure/depth_gate.h:DepthStatus",
                   "lodeline/estimator/pressure/depth_fusion.h:DepthEstimate",
                   "lodeline/estimator/uncertainty/scale_observability.h:ScaleInformation",
                   "lodeline/estimator/estimator.h:FrameEstimate", "lodeline/batch/refine.h:RefinementSummary",
                   "lodeline/batch/refine.h:Refinement"],
    "trajectory.h": ["lodeline/evaluation/trajectory/trajectory.h", "lodeline/evaluation/trajectory/read_trajectory.h",
                     "lodeline/evaluation/trajectory/write_trajectory.h", "lodeline/evaluation/errors/association.h",
                     "lodeline/evaluation/errors/alignment.h", "lodeline/evaluation/errors/statistics.h",
                     "lodeline/evaluation/errors/pose_error.h", "lodeline/evaluation/errors/completion.h",
                     "lodeline/evaluation/errors/claims.h", "lodeline/evaluation/errors/evaluation.h"],
    "rosbag.h": ["lodeline/io/rosbag1/bag_source.h:BagOptions"],
    "simulation.h": ["simulation/dive/effects.h", "simulation/sensors/standard_rig.h", "simulation/dive/scenario.h",
                     "simulation/dive/image_recording.h:ImageProgress",
                     "simulation/dive/image_recording.h:ImageRecordingOptions", "simulation/dive/recording.h"],
    "survey.h": ["lodeline/output/survey/run/landmark_file.h:MapLandmark", "lodeline/output/survey/run/run_folder.h",
                 "lodeline/output/survey/map/survey.h:StationOptions",
                 "lodeline/output/survey/map/passage.h:PassageOptions",
                 "lodeline/output/survey/map/dive_map.h:DiveMapOptions",
                 "lodeline/output/survey/formats/map_files.h:MapFormat"],
}
# Includes beside those of whole headers.
INCLUDES = {
    "estimate.h": ["<cstdint>", "<optional>", "<string>", "<vector>", '"lodeline/types.h"'],
    "recording.h": ["<filesystem>"],
    "rosbag.h": ["<filesystem>", "<map>", "<string>", "<vector>"],
    "simulation.h": ["<functional>", '"lodeline/types.h"'],
    "survey.h": ['"lodeline/estimate.h"', '"lodeline/trajectory.h"'],
}
MOVED = {part: f"lodeline/{header}" for header, parts in PARTS.items() for part in parts if ":" not in part}
INCLUDE = re.compile(r'^#include ([<"])([^>"]+)[>"]$')


def include_after_move(line, present):
    """An include line after the move; nothing where the file has that include already."""
    match = INCLUDE.match(line)
    if match and match.group(1) == '"':
        line = f'#include "{MOVED.get(match.group(2), match.group(2))}"'
    if match and line in present:
        return None
    present.add(line)
    return line


def whole(part):
    """Includes and content of a header, without its guard and namespace."""
    text = (ROOT / "src" / part).read_text()
    includes = [line for line in text.splitlines() if INCLUDE.match(line)]
    content = re.search(r"^namespace lodeline \{\n(.*)^\}  // namespace lodeline$", text, re.M | re.S).group(1)
    return includes, content.strip("\n")


def extract(part, name, header):
    """Takes a type with its comment out of a header, which from now on includes the public one."""
    file = ROOT / "src" / part
    text = file.read_text()
    body = rf"(?:struct|enum class) {name}\b[^;{{]*\{{(?:[^\n]*\}};\n|.*?^\}};\n)|using {name} = [^;]*;\n"
    pattern = re.compile(rf"(?:^///[^\n]*\n)*^(?:{body})(?:^const char\* toString\({name} [^\n]*\n)?\n*", re.M | re.S)
    match = pattern.search(text)
    text = text[:match.start()] + text[match.end():]
    include = f'#include "lodeline/{header}"\n'
    if include not in text:
        place = re.search(r'^#include "', text, re.M) or re.search(r"^namespace ", text, re.M)
        gap = "" if place.group(0).startswith("#") else "\n"
        text = text[:place.start()] + include + gap + text[place.start():]
    file.write_text(text)
    return match.group(0).strip("\n")


def assemble(header, parts):
    includes, contents = [f"#include {name}" for name in INCLUDES.get(header, [])], []
    for part in parts:
        if ":" in part:
            contents.append(extract(*part.split(":"), header))
            continue
        part_includes, content = whole(part)
        includes += part_includes
        contents.append(content)
    present = {f'#include "lodeline/{header}"'}
    includes = [line for line in (include_after_move(line, present) for line in includes) if line]
    public = [f'#include "lodeline/{name}"' for name in PARTS]
    groups = [[line for line in includes if "<" in line], [line for line in includes if line in public]]
    blocks = ["\n".join(group) for group in groups if group]
    return "\n\n".join(["#pragma once", *blocks, "namespace lodeline {", *contents, "}  // namespace lodeline\n"])


def change_includes():
    """Paths of the files in which an include was changed."""
    for top in TOPS:
        for file in sorted((ROOT / top).rglob("*")):
            if file.suffix not in (".h", ".cpp") or "corpus" in file.parts:
                continue
            present, text = set(), file.read_text()
            lines = [include_after_move(line, present) if line.startswith("#include") else line
                     for line in text.split("\n")]
            after = "\n".join(line for line in lines if line is not None)
            if after != text:
                file.write_text(after)
                yield file


def main():
    headers = {header: assemble(header, parts) for header, parts in PARTS.items()}
    (ROOT / "include/lodeline").mkdir(parents=True, exist_ok=True)
    for header, text in headers.items():
        (ROOT / "include/lodeline" / header).write_text(text)
    for part in MOVED:
        (ROOT / "src" / part).unlink()
    changed = {ROOT / "include/lodeline" / header for header in headers} | set(change_includes())
    for parts in PARTS.values():
        changed |= {ROOT / "src" / part.split(":")[0] for part in parts if ":" in part}
    subprocess.run(["clang-format-14", "-i", *sorted(map(str, changed))], cwd=ROOT, check=True)


if __name__ == "__main__":
    main()
