#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reference trajectory for a run.
struct ReportReference {
  std::filesystem::path trajectory;  ///< any path that findTrajectory() accepts
  AlignmentType alignment = AlignmentType::SE3;
};

/// Folder of the ground truth in a recording with the EuRoC layout; empty where it has none.
std::optional<std::filesystem::path> referenceOfRecording(const std::filesystem::path& data);

/// Evaluation of the run's trajectory relative to a reference in the format of the page (`Evaluation` in
/// web/src/data.ts): the values of evaluationJson() with its defaults, errors over time, the reference's
/// path. After SE(3) alignment it also contains the absolute errors after a rotation about the vertical
/// alone, if the reference's world is level; the attitude errors are then those. Throws InputError where
/// either cannot be read or they have no common time.
nlohmann::ordered_json runEvaluationJson(const std::filesystem::path& run, const ReportReference& reference,
                                         int64_t origin_ns);

}  // namespace lodeline
