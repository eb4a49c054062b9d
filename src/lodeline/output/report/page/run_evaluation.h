#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "lodeline/evaluation/errors/alignment.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// What a run is compared with.
struct ReportReference {
  std::filesystem::path trajectory;  ///< anything that findTrajectory() takes
  AlignmentType alignment = AlignmentType::SE3;
};

/// The folder with the ground truth that a recording in the EuRoC layout brings along; nothing where it has
/// none.
std::optional<std::filesystem::path> referenceOfRecording(const std::filesystem::path& data);

/// The run's trajectory against a reference, as the page reads it (`Evaluation` in web/src/data.ts): the
/// figures of evaluationJson() with its defaults, errors over time, the reference's path; after SE(3)
/// alignment, where the reference's world is level, besides the absolute errors after rotation about the
/// vertical alone, from which the errors of attitude are taken then. Throws InputError
/// where either cannot be read or they have nothing in common.
nlohmann::ordered_json runEvaluationJson(const std::filesystem::path& run, const ReportReference& reference,
                                         int64_t origin_ns);

}  // namespace lodeline
