#include "lodeline/evaluation/figures/comparison_report.h"

namespace lodeline {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const PoseRmse& rmse) {
  return {{"rotation_rmse_deg", rmse.rotation_deg}, {"position_rmse_m", rmse.position_m}};
}

Json toJson(const RunErrors& e) {
  Json json;
  json["path_m"] = e.path_m;
  json["span_s"] = e.span_s;
  json["after_sim3"] = toJson(e.sim3);
  json["after_sim3"]["scale"] = e.scale;
  json["after_yaw"] = toJson(e.yaw);
  json["end_point_equal_start_percent"] = e.end_point_equal_start_percent;
  json["against_world"] = {{"heading_from", toString(e.basis)},
                           {"heading_rmse_deg", e.heading_rmse_deg},
                           {"heading_mean_deg", e.heading_mean_deg},
                           {"heading_max_deg", e.heading_max_deg},
                           {"end_point_percent", e.end_point_percent}};
  json["relative_yaw"]["growth_deg_per_100m"] = e.relative_yaw_growth_deg;
  for (const RelativeErrors& r : e.relative) {
    const Statistics yaw = computeStatistics(r.yaw_deg);
    json["relative_yaw"]["stretches"].push_back({{"length_m", r.length_m},
                                                 {"count", yaw.count},
                                                 {"median_deg", yaw.median},
                                                 {"lower_quartile_deg", yaw.lower_quartile},
                                                 {"upper_quartile_deg", yaw.upper_quartile},
                                                 {"rmse_deg", yaw.rmse}});
  }
  return json;
}

Json toJson(const ComparedRun& run) {
  Json json = {{"seed", run.seed}, {"completion_percent", 100.0 * run.completion}};
  if (run.core_ms_per_frame > 0.0) json["core_ms_per_frame"] = run.core_ms_per_frame;
  if (run.errors) {
    json["errors"] = toJson(*run.errors);
  } else {
    json["failure"] = run.failure;
  }
  return json;
}

Json toJson(const MethodMeans& m) {
  Json json = {
      {"runs_with_trajectory", m.runs}, {"runs", m.total_runs}, {"completion_percent", 100.0 * m.completion}};
  if (m.runs == 0) return json;
  json["after_sim3"] = toJson(m.sim3);
  json["after_sim3"]["scale"] = m.scale;
  json["after_yaw"] = toJson(m.yaw);
  json["end_point_equal_start_percent"] = m.end_point_equal_start_percent;
  json["against_world"] = {{"heading_from", toString(m.basis)},
                           {"heading_rmse_deg", m.heading_rmse_deg},
                           {"end_point_percent", m.end_point_percent}};
  json["relative_yaw"] = {{"median_over_longest_deg", m.relative_yaw_deg},
                          {"growth_deg_per_100m", m.relative_yaw_growth_deg}};
  json["core_ms_per_frame"] = m.core_ms_per_frame;
  return json;
}

}  // namespace

Json comparisonJson(const ComparedRecording& recording) {
  Json json = {{"recording", recording.name}, {"extent", recording.extent}, {"methods", Json::array()}};
  for (const ComparedMethod& method : recording.methods) {
    Json entry = {{"method", method.name}, {"mean", toJson(meansOf(method))}, {"runs", Json::array()}};
    for (const ComparedRun& run : method.runs) entry["runs"].push_back(toJson(run));
    json["methods"].push_back(entry);
  }
  return json;
}

}  // namespace lodeline
