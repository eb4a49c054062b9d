#include "lodeline/estimator/pressure/depth_fusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/estimator/uncertainty/covariance_inflation.h"
#include "lodeline/estimator/uncertainty/time_correlated_error.h"
#include "lodeline/factors/sensors/depth_factor.h"

namespace lodeline {
namespace {

constexpr double kReliableSpeed_m_per_s = 0.03;  // largest sigma of a vertical speed to check a gauge with

// Longest time for which a reading is carried. Speeds are interpolated between frames; over a longer gap they
// do not describe the motion.
constexpr double kLongestCarry_s = 1.0;

CarriedDepth meanOf(const std::vector<CarriedDepth>& depths) {
  CarriedDepth mean;
  const double share = 1.0 / static_cast<double>(depths.size());
  for (const CarriedDepth& depth : depths) {
    mean.depth_m += share * depth.depth_m;
    mean.rise_m += share * depth.rise_m;
    mean.rise_by_lag_m_per_s += share * depth.rise_by_lag_m_per_s;
    mean.lag_s = depth.lag_s;
    mean.readings += depth.readings;
  }
  return mean;
}

double statedSigma(const Rig& rig, const DepthOptions& options) {
  return rig.pressure ? options.noise_inflation * rig.pressure->depth_noise_std_m : 0.0;
}

Eigen::VectorXd single(double value) { return Eigen::VectorXd::Constant(1, value); }

}  // namespace

DepthFusion::DepthFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
    : options_(options.depth),
      unmodelled_density_sigma_(unmodelledDensitySigma(options)),
      diagnostics_(diagnostics),
      health_(options_.gate, statedSigma(rig, options_)),
      gate_(options_.gate) {
  if (!options_.use || !rig.pressure) return;
  gauge_ = rig.pressure;
  status_ = DepthStatus::NoData;
}

void DepthFusion::take(const SensorReadings& readings, std::span<const ImuSample>, const Vec3&) {
  waiting_.clear();
  if (!gauge_) return;
  for (const DepthSample& reading : readings.of<DepthSample>()) {
    if (std::isfinite(reading.depth_m)) {
      waiting_.push_back(reading);
      continue;
    }
    diagnostics_->report(
        Severity::Warning, "pressure_invalid",
        fmt::format("pressure sensor: reading at {} ns is no number; left out", reading.time.nanoseconds()));
  }
}

double DepthFusion::portSpeed(const Frame& frame) const {
  const Vec3 rate_B = frame.gyroscope_B - frame.gyroscopeBias();
  const Vec3 arm_speed_B = rate_B.cross(gauge_->body_from_pressure.translation);
  return frame.velocity_W().z() + (frame.worldFromBody().rotation * arm_speed_B).z();
}

CarriedDepth DepthFusion::carry(const DepthSample& reading, Time frame_time, double lag_s) const {
  constexpr double kStep_s = 0.01;
  const auto rise = [&](double lag) { return motion_.riseSince(reading.time, frame_time, lag); };
  CarriedDepth depth;
  depth.depth_m = reading.depth_m;
  depth.rise_m = rise(lag_s);
  depth.rise_by_lag_m_per_s = (rise(lag_s + kStep_s) - rise(lag_s - kStep_s)) / (2.0 * kStep_s);
  depth.lag_s = lag_s;
  depth.readings = 1;
  return depth;
}

void DepthFusion::addToNewest(Window& window, Marginalizer& marginalizer) {
  if (!gauge_) return;
  Frame& newest = window.newest();
  const Frame& before = **std::prev(window.frames().end(), 2);
  if (before.has_motion) motion_.add(before.time, portSpeed(before));
  motion_.add(newest.time, portSpeed(newest));
  status_ = DepthStatus::NoData;
  std::vector<CarriedDepth> used;
  double variance_scale = 1.0;
  const Time earliest = newest.time - Duration::fromSeconds(kLongestCarry_s);
  std::erase_if(waiting_, [&](const DepthSample& reading) { return reading.time < earliest; });
  for (const DepthSample& reading : waiting_) {
    const DepthStates states(window);
    const CarriedDepth depth = carry(reading, newest.time, states ? states.lag_s() : options_.lag_s);
    if (!states) begin(depth, window, marginalizer);
    const DepthDecision decision = judge(reading, depth, window, marginalizer);
    // Among several readings, one that was not Used determines the status of the frame.
    if (status_ == DepthStatus::NoData || decision.status != DepthStatus::Used) status_ = decision.status;
    if (decision.status == DepthStatus::Restarted) used.clear();
    if (!decision.use) continue;
    used.push_back(depth);
    variance_scale = std::max(variance_scale, decision.variance_scale);
  }
  restarts_ += status_ == DepthStatus::Restarted;
  if (!used.empty()) newest.measurements.set(measurementOf(used, variance_scale, newest.time));
}

DepthDecision DepthFusion::judge(const DepthSample& reading, const CarriedDepth& depth, Window& window,
                                 Marginalizer& marginalizer) {
  const Innovation innovation = innovate(depth, window);
  const bool is_reliable =
      innovation.speed_sigma_m_per_s < kReliableSpeed_m_per_s && innovation.elapsed_s < kLongestCarry_s;
  const bool is_noise = is_reliable && innovation.lag_sigma_m < health_.readingSigma();
  const DepthStatus health = health_.check(reading, motion_, depth.lag_s, is_reliable);
  health_.learnScatter(is_noise ? std::optional(innovation.value_m) : std::nullopt);
  DepthDecision decision = gate_.decide(reading.time, innovation.value_m, innovation.sigma_m);
  if (is_slope_wrong_ && health == DepthStatus::Used) decision = {DepthStatus::Restarted, true};
  if (health != DepthStatus::Used) decision = {health};
  if (decision.status == DepthStatus::Restarted || (health == DepthStatus::Slope && !is_slope_wrong_))
    restart(depth, window, marginalizer);
  is_slope_wrong_ = health == DepthStatus::Slope;
  report(decision.status, reading);
  return decision;
}

DepthFusion::Innovation DepthFusion::innovate(const CarriedDepth& depth, const Window& window) const {
  const DepthStates states(window);
  const Frame& newest = window.newest();
  const Frame& before = **std::prev(window.frames().end(), 2);
  const DepthFactor factor(depth, gauge_->body_from_pressure.translation, 1.0);
  const double* values[] = {newest.pose.data(), states.offset->value.data(), states.scale->value.data(),
                            states.lag->value.data()};
  Eigen::Matrix<double, 1, kPoseSize> by_pose;
  double by_state[3];
  double* jacobians[] = {by_pose.data(), &by_state[0], &by_state[1], &by_state[2]};
  Innovation innovation;
  factor.Evaluate(values, &innovation.value_m, jacobians);

  // Covariances of the frame before, propagated with the uncertainty of the speed since then.
  const double elapsed_s = innovation.elapsed_s = (newest.time - before.time).seconds();
  std::vector<std::pair<const double*, Eigen::RowVectorXd>> derivatives = {
      {before.pose.data(), by_pose.head<kPoseTangentSize>()}};
  Eigen::RowVectorXd by_motion = Eigen::RowVectorXd::Zero(kMotionSize);
  const Eigen::RowVector3d up_B = before.worldFromBody().rotation.toRotationMatrix().row(2);
  by_motion[2] = by_pose[2] * elapsed_s;
  by_motion.tail<3>() = -0.5 * elapsed_s * elapsed_s * by_pose[2] * up_B;  // by the accelerometer bias
  derivatives.emplace_back(before.motion.data(), by_motion);
  for (int i = 0; i < 3; ++i)
    derivatives.emplace_back(values[1 + i], Eigen::RowVectorXd(single(by_state[i])));
  const double reading_sigma_m = health_.readingSigma();
  const Mat3 way_covariance =
      newest.from_previous->covariance().block<3, 3>(inertial_error::kAlpha, inertial_error::kAlpha);
  double variance_m2 = reading_sigma_m * reading_sigma_m + options_.floor_m * options_.floor_m +
                       by_pose[2] * by_pose[2] * (up_B * way_covariance * up_B.transpose()).value();
  for (const auto& [row, by_row] : derivatives) {
    for (const auto& [column, by_column] : derivatives) {
      if (!covariance_.knows(row) || !covariance_.knows(column)) continue;
      variance_m2 += by_row.dot(covariance_.between(row, column) * by_column.transpose());
    }
  }
  const double* lag = states.lag->value.data();
  const double lag_sigma_s =
      covariance_.knows(lag) ? std::sqrt(covariance_.between(lag, lag)(0, 0)) : options_.lag_sigma_s;
  innovation.lag_sigma_m = std::abs(by_state[2]) * lag_sigma_s;
  innovation.sigma_m = std::sqrt(variance_m2);
  if (!covariance_.empty()) innovation.speed_sigma_m_per_s = std::sqrt(covariance_.newest()(8, 8));
  return innovation;
}

void DepthFusion::remember(const JointCovariance& covariance, Window& window) {
  covariance_ = covariance;
  const DepthStates states(window);
  if (!options_.water_density_prior || options_.density_ratio_sigma <= kOneWaterSigma || !states) return;
  const std::optional<ScalarPrior> seen = seenRatio(*states.scale);
  if (!seen) return;
  const ScalarPrior honest{seen->value, std::hypot(seen->sigma, unmodelled_density_sigma_)};
  known_ratio_ = amongWaterDensities(honest);
  states.scale->priors.clear();
  likelihood_ = likelihoodBetween(honest, *known_ratio_);
  if (!likelihood_) return;
  // The window's sigma of the ratio is smaller than the true one. The likelihood's sigma is reduced by the
  // same factor, so that both keep their relative weight.
  states.scale->priors = {{likelihood_->value, likelihood_->sigma * seen->sigma / honest.sigma}};
}

std::optional<ScalarPrior> DepthFusion::seenRatio(const ParameterBlock& scale) const {
  const double* value = scale.value.data();
  if (!covariance_.knows(value)) return std::nullopt;
  const ScalarPrior all{scale.value[0], std::sqrt(std::max(0.0, covariance_.between(value, value)(0, 0)))};
  if (!(all.sigma > 0.0)) return std::nullopt;
  return scale.priors.empty() ? all : without(scale.priors.front(), all);
}

void DepthFusion::begin(const CarriedDepth& depth, Window& window, Marginalizer& marginalizer) {
  const Rigid3& body_from_port = gauge_->body_from_pressure;
  const double height_m = (window.newest().worldFromBody() * body_from_port.translation).z() - depth.rise_m;
  const double ratio = options_.density_ratio;
  const auto add = [&](const char* name, double value, double sigma, double walk_per_sqrt_s) {
    ParameterBlock& state = window.add({name, {value}, std::nullopt, walk_per_sqrt_s, true});
    // Small enough to hold a state, large enough for a well conditioned prior.
    marginalizer.addKnowledge(state, single(std::max(sigma, 1e-7)));
  };
  add(DepthStates::kOffset, depth.depth_m + ratio * height_m, options_.offset_sigma_m,
      options_.offset_walk_m_per_sqrt_s);
  add(DepthStates::kScale, ratio, options_.density_ratio_sigma, 0.0);
  add(DepthStates::kLag, options_.lag_s, options_.lag_sigma_s, 0.0);
}

void DepthFusion::restart(const CarriedDepth& depth, Window& window, Marginalizer& marginalizer) {
  for (const auto& frame : window.frames()) frame->measurements.remove<DepthMeasurement>();
  ParameterBlock& offset = *DepthStates(window).offset;
  marginalizer.forget(window, offset);
  offset.value[0] += innovate(depth, window).value_m;
  marginalizer.addKnowledge(offset, single(options_.offset_sigma_m));
  last_used_.reset();
}

DepthMeasurement DepthFusion::measurementOf(const std::vector<CarriedDepth>& depths, double variance_scale,
                                            Time time) {
  DepthMeasurement measurement;
  measurement.depth = meanOf(depths);
  measurement.port_B = gauge_->body_from_pressure.translation;
  const double shared = timeCorrelatedShare(time, last_used_, options_.correlated_noise_time_s);
  const double variance_m2 = std::pow(health_.readingSigma(), 2) / measurement.depth.readings +
                             shared * std::pow(options_.floor_m, 2);
  measurement.sigma_m = std::sqrt(variance_scale * variance_m2);
  last_used_ = time;
  return measurement;
}

void DepthFusion::report(DepthStatus status, const DepthSample& reading) {
  const auto warn = [&](const char* kind, const std::string& message) {
    diagnostics_->report(Severity::Warning, kind, "pressure sensor: " + message);
  };
  const int64_t now_ns = reading.time.nanoseconds();
  if (status == DepthStatus::Jump) {
    warn("pressure_rejected", fmt::format("reading of {:g} m at {} ns jumps away from the others; not used",
                                          reading.depth_m, now_ns));
  } else if (status == DepthStatus::Restarted) {
    warn("pressure_restarted",
         fmt::format("from {} ns on used with a new offset; heights before and after are tied by images and "
                     "inertial readings alone",
                     now_ns));
  } else if (status == DepthStatus::Frozen) {
    warn("pressure_frozen",
         fmt::format("nothing but {:g} m at {} ns, though the rig rises or sinks; not used until it changes",
                     reading.depth_m, now_ns));
  } else if (status == DepthStatus::Slope) {
    const double slope = health_.slope().value_or(0.0);
    warn("pressure_slope",
         fmt::format("at {} ns its readings change by {:.3g} for each metre that the rig sinks; not used. {}",
                     now_ns, slope, explainSlope(slope)));
  }
}

void DepthFusion::report(const Window& window, SensorEstimates* estimates) const {
  estimates->set(estimate(window));
}

std::vector<BatchState> DepthFusion::batchStates(const Window& window) const {
  const DepthStates states(window);
  if (!states) return {};
  BatchState offset{DepthStates::kOffset}, scale{DepthStates::kScale}, lag{DepthStates::kLag};
  offset.is_added_late = scale.is_added_late = lag.is_added_late = true;
  offset.walk_per_sqrt_s = options_.offset_walk_m_per_sqrt_s;
  offset.restarts = true;
  offset.sigma = options_.offset_sigma_m;
  scale.value = {options_.density_ratio};
  scale.sigma = std::max(options_.density_ratio_sigma, 1e-7);
  scale.priors = states.scale->priors;
  lag.value = {options_.lag_s};
  lag.sigma = std::max(options_.lag_sigma_s, 1e-7);
  return {offset, scale, lag};
}

DepthEstimate DepthFusion::estimate(const Window& window) const {
  DepthEstimate estimate;
  estimate.status = status_;
  const DepthStates states(window);
  if (!states) return estimate;
  const auto sigma = [&](const ParameterBlock& state) {
    const double* value = state.value.data();
    return covariance_.knows(value) ? std::sqrt(std::max(0.0, covariance_.between(value, value)(0, 0))) : 0.0;
  };
  DepthEstimate::Gauge gauge;
  gauge.depth_at_origin_m = states.offset_m();
  gauge.density_ratio = states.density_ratio();
  const double window_sigma = sigma(*states.scale);
  gauge.density_ratio_sigma =
      known_ratio_ ? known_ratio_->sigma : std::hypot(window_sigma, unmodelled_density_sigma_);
  gauge.unmodelled_sigma =
      std::sqrt(std::max(0.0, std::pow(gauge.density_ratio_sigma, 2) - window_sigma * window_sigma));
  gauge.told_sigma = options_.density_ratio_sigma;
  if (likelihood_) gauge.told_sigma = 1.0 / std::hypot(1.0 / gauge.told_sigma, 1.0 / likelihood_->sigma);
  if (!states.scale->priors.empty()) gauge.prior = states.scale->priors.front();
  gauge.lag_s = states.lag_s();
  gauge.lag_sigma_s = sigma(*states.lag);
  gauge.body_depth_m =
      gauge.depth_at_origin_m / gauge.density_ratio - window.newest().worldFromBody().translation.z();
  estimate.gauge = gauge;
  return estimate;
}

}  // namespace lodeline
