#include "lodeline/estimator/trials/trial_currents.h"

#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kSpan_s = 0.5;  // in which a thruster reaches its new current
constexpr double kTrialLamp_A = 2.0;

/// Levels that hold for some seconds; a thruster idles for a third of the time.
std::vector<double> thrusterNodes(double largest_A, size_t count, Random& random) {
  std::vector<double> nodes;
  while (nodes.size() < count) {
    const double level_A = random.uniform() < 0.33 ? 0.0 : largest_A * std::pow(random.uniform(), 1.5);
    const int spans = 2 + static_cast<int>(14.0 * random.uniform());
    nodes.insert(nodes.end(), static_cast<size_t>(spans), level_A);
  }
  return nodes;
}

}  // namespace

TrialCurrents::TrialCurrents(const TrialCurrentOptions& options, double duration_s, uint64_t seed)
    : options_(options) {
  const auto count = static_cast<size_t>(duration_s / kSpan_s) + 2;
  for (int i = 0; i <= options.thrusters; ++i) {
    Random random(seed, "trial currents/" + std::to_string(i));
    const bool is_lamp = i == options.thrusters;
    const Vec3 calibrated = (is_lamp ? 0.1e-6 : options.field_T_per_A) * random.direction();
    calibrated_.push_back(calibrated + options.calibration_sigma_T_per_A * random.normal3());
    fields_.push_back(so3::exp(options.moved_rad * random.direction()) * calibrated);
    std::vector<double> nodes = thrusterNodes(is_lamp ? kTrialLamp_A : options.largest_A, count, random);
    if (is_lamp)
      std::transform(nodes.begin(), nodes.end(), nodes.begin(), [](double) { return kTrialLamp_A; });
    // The vehicle lies still at first.
    std::fill_n(nodes.begin(), std::min<size_t>(nodes.size(), 6), 0.0);
    nodes_.push_back(std::move(nodes));
  }
}

Eigen::VectorXd TrialCurrents::at_A(double time_s) const {
  Eigen::VectorXd currents_A(static_cast<Eigen::Index>(nodes_.size()));
  const double at = std::max(0.0, time_s / kSpan_s);
  for (size_t i = 0; i < nodes_.size(); ++i) {
    const size_t node = std::min(static_cast<size_t>(at), nodes_[i].size() - 2);
    const double share = std::min(1.0, at - static_cast<double>(node));
    currents_A[static_cast<Eigen::Index>(i)] = (1.0 - share) * nodes_[i][node] + share * nodes_[i][node + 1];
  }
  return currents_A;
}

Vec3 TrialCurrents::field_M(double time_s) const {
  const Eigen::VectorXd currents_A = at_A(time_s);
  Vec3 field = Vec3::Zero();
  for (size_t i = 0; i < fields_.size(); ++i) field += currents_A[static_cast<Eigen::Index>(i)] * fields_[i];
  return field;
}

CurrentCalibration TrialCurrents::calibration() const {
  CurrentCalibration calibration;
  calibration.rate_hz = options_.rate_hz;
  for (size_t i = 0; i < fields_.size(); ++i)
    calibration.channels.push_back(i + 1 < fields_.size() ? "thruster_" + std::to_string(i + 1) : "lamp");
  if (!options_.is_calibrated) return calibration;
  calibration.fields_T_per_A = calibrated_;
  calibration.field_sigma_T_per_A = options_.calibration_sigma_T_per_A;
  return calibration;
}

std::vector<CurrentSample> TrialCurrents::readings(Time start, double after_s, double to_s) const {
  std::vector<CurrentSample> samples;
  for (auto i = static_cast<int64_t>(std::floor(after_s * options_.rate_hz)) + 1;; ++i) {
    const double time_s = static_cast<double>(i) / options_.rate_hz;
    if (time_s > to_s) return samples;
    if (time_s >= options_.gap_begin_s && time_s < options_.gap_begin_s + options_.gap_s) continue;
    const Eigen::VectorXd currents_A = at_A(time_s);
    samples.push_back({start + Duration::fromSeconds(time_s), {currents_A.begin(), currents_A.end()}});
  }
}

}  // namespace lodeline
