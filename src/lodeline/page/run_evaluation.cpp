#include "lodeline/page/run_evaluation.h"

#include <numeric>

#include "lodeline/evaluation/evaluation.h"
#include "lodeline/evaluation/evaluation_report.h"
#include "lodeline/evaluation/read_trajectory.h"
#include "lodeline/page/row_choice.h"
#include "lodeline/page/table_json.h"

namespace lodeline {
namespace {

nlohmann::ordered_json errorsJson(const Evaluation& evaluation, int64_t origin_ns) {
  RunTable table;
  for (const Time time : evaluation.pairs.time) table.stamp_ns.push_back(time.nanoseconds());
  for (const Vec3& error : evaluation.absolute.position_m) {
    table.numbers["position [m]"].push_back(error.norm());
  }
  table.numbers["rotation [deg]"] = evaluation.absolute.rotation_deg;
  table.numbers["yaw [deg]"] = evaluation.absolute.yaw_deg;
  return tableJson(table, origin_ns);
}

/// The reference while the run lasted.
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
  return {{"figures", evaluationJson(evaluation, remarks)},
          {"errors", errorsJson(evaluation, origin_ns)},
          {"path", pathJson(evaluation, origin_ns)}};
}

}  // namespace lodeline
