#include "lodeline/output/report/page/run_evaluation.h"

#include <optional>

#include "lodeline/evaluation/figures/evaluation_report.h"
#include "lodeline/output/report/data/row_choice.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

/// `attitudes`: the evaluation of which the attitude errors are shown.
nlohmann::ordered_json errorsJson(const Evaluation& evaluation, const Evaluation& attitudes,
                                  int64_t origin_ns) {
  RunTable table;
  for (const Time time : evaluation.pairs.time) table.stamp_ns.push_back(time.nanoseconds());
  for (const Vec3& error : evaluation.absolute.position_m) {
    table.numbers["position [m]"].push_back(error.norm());
  }
  table.numbers["rotation [deg]"] = attitudes.absolute.rotation_deg;
  table.numbers["yaw [deg]"] = attitudes.absolute.yaw_deg;
  return tableJson(table, origin_ns);
}

/// Evaluation after rotation about the vertical alone, if the alignment is SE(3). On a nearly straight line,
/// positions do not determine the rotation about it, which is then not an error of the run. Empty where the
/// reference's world is not level.
std::optional<Evaluation> yawAligned(const Evaluation& evaluation, Diagnostics* remarks) {
  if (evaluation.options.alignment != AlignmentType::SE3) return std::nullopt;
  EvaluationOptions options = evaluation.options;
  options.alignment = AlignmentType::Yaw;
  Evaluation level = evaluate(evaluation.estimate, evaluation.reference, options, *remarks);
  constexpr double kNotLevel_deg = 5.0;
  if (level.absolute.rotation().rmse > evaluation.absolute.rotation().rmse + kNotLevel_deg)
    return std::nullopt;
  return level;
}

/// The reference within the time of the run.
nlohmann::ordered_json pathJson(const Evaluation& evaluation, int64_t origin_ns) {
  std::vector<int64_t> stamp_ns;
  std::vector<double> coordinates[3];
  for (const StampedPose& pose : evaluation.reference.poses) {
    if (pose.time < evaluation.pairs.time.front() || pose.time > evaluation.pairs.time.back()) continue;
    stamp_ns.push_back(pose.time.nanoseconds());
    for (int i = 0; i < 3; ++i) coordinates[i].push_back(pose.world_from_body.translation[i]);
  }
  const RowChoice choice = chooseRows(stamp_ns.size(), kMostRows, {});
  return {{"t_s", secondsSince(origin_ns, stamp_ns, choice.rows)},
          {"x", shortNumbers(coordinates[0], choice.rows)},
          {"y", shortNumbers(coordinates[1], choice.rows)},
          {"z", shortNumbers(coordinates[2], choice.rows)}};
}

}  // namespace

std::optional<std::filesystem::path> referenceOfRecording(const std::filesystem::path& data) {
  for (const std::filesystem::path& base : {data / "mav0", data}) {
    const std::filesystem::path folder = base / "state_groundtruth_estimate0";
    if (std::filesystem::is_directory(folder)) return folder;
  }
  return std::nullopt;
}

nlohmann::ordered_json runEvaluationJson(const std::filesystem::path& run, const ReportReference& reference,
                                         int64_t origin_ns) {
  Diagnostics remarks;
  EvaluationOptions options;
  options.alignment = reference.alignment;
  const Evaluation evaluation = evaluate(readTrajectory(run, {}, remarks),
                                         readTrajectory(reference.trajectory, {}, remarks), options, remarks);
  const std::optional<Evaluation> level = yawAligned(evaluation, &remarks);
  nlohmann::ordered_json json = {{"figures", evaluationJson(evaluation, remarks)}, {"yaw_aligned", nullptr}};
  if (level) json["yaw_aligned"] = evaluationJson(*level, remarks)["absolute"];
  json["errors"] = errorsJson(evaluation, level ? *level : evaluation, origin_ns);
  json["path"] = pathJson(evaluation, origin_ns);
  return json;
}

}  // namespace lodeline
