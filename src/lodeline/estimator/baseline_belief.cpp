#include "lodeline/estimator/baseline_belief.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/estimator/camera_states.h"
#include "lodeline/estimator/lens_trust.h"

namespace lodeline {

double oddsForBaseline(const Belief& seen, double stated_sigma_m, double baseline_m) {
  constexpr double kRight = 0.9;
  constexpr double kRange = 0.2;  // of the baseline, both ways together
  const double sigma_m = std::hypot(seen.sigma, stated_sigma_m);
  const double sigmas = seen.value / sigma_m;
  const double right =
      std::log(kRight / (std::sqrt(2.0 * std::numbers::pi) * sigma_m)) - 0.5 * sigmas * sigmas;
  return right - std::log((1.0 - kRight) / (kRange * baseline_m));
}

BaselineBelief::BaselineBelief(const Rig& rig, const EstimatorOptions& options)
    : options_(options.camera_calibration), accelerometer_sigma_(options.imu_axes.accelerometerSigma()) {
  for (size_t i = 1; i < rig.cameras.size(); ++i) {
    const Vec3 baseline =
        (rig.cameras.front().body_from_camera.inverse() * rig.cameras[i].body_from_camera).translation;
    baselines_.push_back({baseline.normalized(), baseline.norm()});
  }
}

void BaselineBelief::remember(const JointCovariance& covariance, Window& window) {
  // Logarithms of the odds at which a file is believed no more, and believed again.
  constexpr double kEnd = 0.0, kBegin = 2.0;
  // Who measured lenses and rotations well is off by a wrong length of the target, or by little.
  constexpr double kWhereLensesAreRight = 0.5;
  if (!options_.enabled || options_.stereo_position_sigma_m <= 0.0) return;
  const CameraStates states = cameraStates(window);
  for (size_t i = 0; i < states.further.size(); ++i) {
    GlobalState& further = *states.further[i];
    Baseline& baseline = baselines_[i];
    further.is_correlation_wanted = true;
    const double stated_sigma_m =
        options_.stereo_position_sigma_m * (isHeldAtFile(further) ? kWhereLensesAreRight : 1.0);
    if (auto without_file = seen(further, baseline, covariance)) {
      without_file->sigma = std::hypot(without_file->sigma, accelerometer_sigma_ * baseline.length_m);
      const double odds = oddsForBaseline(*without_file, stated_sigma_m, baseline.length_m);
      baseline.is_believed =
          odds > (baseline.is_believed ? kEnd : kBegin) && (baseline.is_believed || !isMoving());
    }
    baseline.solutions_since = baseline.is_believed ? 0 : baseline.solutions_since + 1;
    further.believe(
        kPlace, std::vector<Belief>(3, baseline.is_believed ? Belief{0.0, stated_sigma_m} : kNothingKnown));
  }
}

bool BaselineBelief::isMoving() const {
  constexpr int kSolutions = 30;
  return std::any_of(baselines_.begin(), baselines_.end(), [](const Baseline& baseline) {
    return !baseline.is_believed && baseline.solutions_since < kSolutions;
  });
}

std::optional<Belief> BaselineBelief::seen(const GlobalState& further, const Baseline& baseline,
                                           const JointCovariance& covariance) {
  const double* value = further.value.data();
  if (!covariance.knows(value)) return std::nullopt;
  const Mat3 position = covariance.between(value, value).bottomRightCorner<3, 3>();
  const Vec3& along = baseline.direction_C0;
  const Belief all{along.dot(Eigen::Map<const Vec3>(value + kPlace)), std::sqrt(along.dot(position * along))};
  if (!(all.sigma > 0.0)) return std::nullopt;
  const Belief told = further.belief(kPlace);
  return std::isfinite(told.sigma) ? without(told, all) : all;
}

}  // namespace lodeline
