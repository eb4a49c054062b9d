#include "lodeline/evaluation/errors/run_errors.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

PoseRmse rmseOf(const AbsoluteErrors& errors) { return {errors.rotation().rmse, errors.position().rmse}; }

double medianYaw_deg(const RelativeErrors& errors) { return computeStatistics(errors.yaw_deg).median; }

/// Least-squares slope of the medians over the lengths.
double yawGrowth_deg(const std::vector<RelativeErrors>& relative) {
  const double count = static_cast<double>(relative.size());
  if (relative.size() < 2) return 0.0;
  double mean_m = 0.0, mean_deg = 0.0;
  for (const RelativeErrors& r : relative) {
    mean_m += r.length_m / count;
    mean_deg += medianYaw_deg(r) / count;
  }
  double covariance = 0.0, variance = 0.0;
  for (const RelativeErrors& r : relative) {
    covariance += (r.length_m - mean_m) * (medianYaw_deg(r) - mean_deg);
    variance += (r.length_m - mean_m) * (r.length_m - mean_m);
  }
  return variance > 0.0 ? 100.0 * covariance / variance : 0.0;
}

/// Errors of the aligned poses relative to the world itself.
void compareWithWorld(const Evaluation& e, HeadingBasis basis, RunErrors* errors) {
  const Alignment equal_start = alignFirstPose(AlignmentType::Yaw, e.pairs, 1.0);
  const Alignment alignment = alignStarts(basis, e.pairs);
  const std::vector<Rigid3> poses = applyAlignment(alignment, e.pairs.estimate);
  const AbsoluteErrors absolute = computeAbsoluteErrors(poses, e.pairs.reference);
  const Statistics yaw = absolute.yaw();
  errors->basis = basis;
  errors->heading_rmse_deg = yaw.rmse;
  errors->heading_max_deg = yaw.max;
  errors->heading_mean_deg = computeStatistics(absolute.yaw_deg).mean;
  errors->end_point_percent = e.percentOfPath(absolute.position_m.back().norm());
  const Vec3 end = equal_start.apply(e.pairs.estimate.back()).translation;
  errors->end_point_equal_start_percent =
      e.percentOfPath((end - e.pairs.reference.back().translation).norm());
  const Vec3 origin = e.pairs.reference.front().translation;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    errors->estimate_track_m.push_back(poses[i].translation - origin);
    errors->reference_track_m.push_back(e.pairs.reference[i].translation - origin);
  }
}

}  // namespace

double RunErrors::relativeYaw_deg() const { return relative.empty() ? 0.0 : medianYaw_deg(relative.back()); }

RunErrors computeRunErrors(const Trajectory& estimate, const Trajectory& reference, HeadingBasis basis,
                           const EvaluationOptions& options, Diagnostics& diagnostics) {
  EvaluationOptions with_yaw = options;
  with_yaw.alignment = AlignmentType::Yaw;
  const Evaluation e = evaluate(estimate, reference, with_yaw, diagnostics);
  RunErrors errors;
  errors.yaw = rmseOf(e.absolute);
  errors.relative = e.relative;
  errors.relative_yaw_growth_deg = yawGrowth_deg(e.relative);
  errors.path_m = e.reference_path_m;
  errors.span_s = (e.pairs.time.back() - e.pairs.time.front()).seconds();
  errors.completion = e.completion;
  const Alignment sim3 = align(AlignmentType::Sim3, e.pairs);
  errors.sim3 = rmseOf(computeAbsoluteErrors(applyAlignment(sim3, e.pairs.estimate), e.pairs.reference));
  errors.scale = sim3.scale;
  compareWithWorld(e, basis, &errors);
  return errors;
}

}  // namespace lodeline
