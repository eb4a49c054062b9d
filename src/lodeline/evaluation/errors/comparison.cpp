#include "lodeline/evaluation/errors/comparison.h"

namespace lodeline {
namespace {

void add(const RunErrors& errors, double share, MethodMeans* means) {
  if (errors.basis == HeadingBasis::Start) means->basis = HeadingBasis::Start;
  means->sim3.rotation_deg += share * errors.sim3.rotation_deg;
  means->sim3.position_m += share * errors.sim3.position_m;
  means->yaw.rotation_deg += share * errors.yaw.rotation_deg;
  means->yaw.position_m += share * errors.yaw.position_m;
  means->scale += share * errors.scale;
  means->heading_rmse_deg += share * errors.heading_rmse_deg;
  means->end_point_percent += share * errors.end_point_percent;
  means->end_point_equal_start_percent += share * errors.end_point_equal_start_percent;
  means->relative_yaw_deg += share * errors.relativeYaw_deg();
  means->relative_yaw_growth_deg += share * errors.relative_yaw_growth_deg;
}

}  // namespace

MethodMeans meansOf(const ComparedMethod& method) {
  MethodMeans means;
  means.total_runs = static_cast<int>(method.runs.size());
  means.basis = HeadingBasis::North;
  for (const ComparedRun& run : method.runs) means.runs += run.errors ? 1 : 0;
  for (const ComparedRun& run : method.runs) {
    means.completion += run.completion / means.total_runs;
    if (!run.errors) continue;
    add(*run.errors, 1.0 / means.runs, &means);
    means.core_ms_per_frame += run.core_ms_per_frame / means.runs;
  }
  if (means.runs == 0) means.basis = HeadingBasis::Start;
  return means;
}

const ComparedMethod* baselineOf(const ComparedRecording& recording) {
  for (const ComparedMethod& method : recording.methods) {
    if (method.name == "off") return &method;
  }
  return recording.methods.empty() ? nullptr : &recording.methods.front();
}

}  // namespace lodeline
