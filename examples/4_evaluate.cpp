// Compares an estimated trajectory with a reference, in any layout that `lodeline evaluate` reads:
//   example_4_evaluate ESTIMATE REFERENCE
// Without arguments, it compares a simulated estimate with a simulated reference.

#include <cmath>
#include <cstdio>
#include <exception>

#include "lodeline/trajectory.h"

namespace {

/// A rising circle with a radius of 5 m, 10 poses per second for a minute, with a constant heading drift.
lodeline::Trajectory circle(double drift_rad_per_s) {
  lodeline::Trajectory trajectory;
  for (int i = 0; i < 600; ++i) {
    const double t = 0.1 * i, angle = 0.1 * t;
    const lodeline::Quat drift(Eigen::AngleAxisd(drift_rad_per_s * t, lodeline::Vec3::UnitZ()));
    const lodeline::Quat heading(Eigen::AngleAxisd(angle, lodeline::Vec3::UnitZ()));
    const lodeline::Vec3 position(5.0 * std::sin(angle), 5.0 - 5.0 * std::cos(angle), 0.02 * t);
    trajectory.poses.push_back(
        {lodeline::Time::fromSeconds(1.8e9 + t), lodeline::Rigid3(drift * heading, drift * position)});
  }
  return trajectory;
}

}  // namespace

int main(int argc, char** argv) try {
  lodeline::Diagnostics diagnostics;
  const bool has_files = argc == 3;
  const lodeline::Trajectory estimate =
      has_files ? lodeline::readTrajectory(argv[1], {}, diagnostics) : circle(0.5e-3);
  const lodeline::Trajectory reference =
      has_files ? lodeline::readTrajectory(argv[2], {}, diagnostics) : circle(0.0);

  lodeline::EvaluationOptions options;
  options.alignment = lodeline::AlignmentType::SE3;
  const lodeline::Evaluation evaluation = lodeline::evaluate(estimate, reference, options, diagnostics);
  const lodeline::Statistics position_m = evaluation.absolute.position();
  const lodeline::Statistics rotation_deg = evaluation.absolute.rotation();
  std::printf("%zu pairs on %.1f m, %.1f %% of the images or the time have a pose\n", evaluation.pairs.size(),
              evaluation.reference_path_m, 100.0 * evaluation.completion.share);
  std::printf("position error %.3f m RMS, %.3f m at most; rotation error %.2f deg RMS\n", position_m.rmse,
              position_m.max, rotation_deg.rmse);
  for (const lodeline::RelativeErrors& relative : evaluation.relative) {
    std::printf("over %5.1f m: %.3f m, %.2f deg (medians)\n", relative.length_m,
                lodeline::computeStatistics(relative.translation_m).median,
                lodeline::computeStatistics(relative.rotation_deg).median);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
