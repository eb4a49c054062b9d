#include "lodeline/batch/refined_frames.h"

#include <cmath>
#include <limits>

#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/estimator/pressure/depth_states.h"
#include "lodeline/estimator/state/inertial_states.h"
#include "lodeline/estimator/uncertainty/covariance_inflation.h"
#include "lodeline/estimator/uncertainty/reported_covariance.h"

namespace lodeline {
namespace {

using Mat15 = Eigen::Matrix<double, 15, 15>;

class FrameMaker {
 public:
  FrameMaker(const BatchProblem& problem, const Rig& rig, const EstimatorOptions& options,
             const EstimatorLog& record, const BatchCovariances& posterior, const BatchCovariances& reported)
      : problem_(problem),
        rig_(rig),
        options_(options),
        record_(record),
        covariance_inflation_(options),
        posterior_(posterior),
        reported_(reported) {}

  FrameEstimate make(const FrameEstimate& forward) {
    while (state_ + 1 < problem_.states() && problem_.state(state_ + 1).time <= forward.time) ++state_;
    FrameEstimate refined = forward;
    const Frame& begin = problem_.state(state_);
    const bool is_state = begin.time == forward.time;
    const double share = is_state || state_ + 1 == problem_.states()
                             ? 0.0
                             : (forward.time - begin.time).seconds() /
                                   (problem_.state(state_ + 1).time - begin.time).seconds();
    refined.state = is_state ? begin.state() : between(begin, forward.time, share);
    refined.covariance = covarianceAt(reported_, share);
    refined.posterior_covariance = covarianceAt(posterior_, share);
    describeNorth(share, &refined);
    addDoubtAboutUp(options_.imu_axes, &refined.covariance);
    refined.camera_corrections = cameraCorrections(problem_.window());
    refined.gyroscope_axes = gyroscopeAxes(problem_.window());
    refined.accelerometer_axes = accelerometerAxes(problem_.window());
    describeMagnetometer(&refined);
    describeDepth(&refined);
    covariance_inflation_.follow(refined.state.world_from_body, forward.scene_distance_m);
    covariance_inflation_.addTo({rig_.cameras.size() > 1, refined.depth.unmodelledDensitySigma(),
                                 refined.magnetometer.field_W.has_value(), !options_.imu_axes.areDoubted()},
                                &refined.covariance);
    addHeadingError(refined.magnetometer.axes_sigma_rad, refined.state, &refined.covariance);
    refined.magnetometer.heading_sigma_rad =
        std::hypot(std::sqrt(refined.covariance(5, 5)), refined.magnetometer.declination_sigma_rad);
    return refined;
  }

 private:
  NavigationState predictTo(const Frame& begin, Time time) const {
    const Preintegration interval(record_.imuBetween(begin.time, time), begin.gyroscopeBias(),
                                  begin.accelerometerBias(), rig_.imu, options_.preintegration);
    return predict(begin.state(), interval, options_.gravity_W);
  }

  NavigationState between(const Frame& begin, Time time, double share) const {
    NavigationState state = predictTo(begin, time);
    if (state_ + 1 == problem_.states()) return state;
    const Frame& end = problem_.state(state_ + 1);
    const NavigationState missed = predictTo(begin, end.time);
    state.world_from_body = perturbed(
        state.world_from_body, share * perturbationBetween(missed.world_from_body, end.worldFromBody()));
    state.velocity_W += share * (end.velocity_W() - missed.velocity_W);
    state.gyroscope_bias_B += share * (end.gyroscopeBias() - begin.gyroscopeBias());
    state.accelerometer_bias_B += share * (end.accelerometerBias() - begin.accelerometerBias());
    return state;
  }

  Mat15 covarianceAt(const BatchCovariances& known, double share) const {
    if (known.empty()) return Mat15::Constant(std::numeric_limits<double>::quiet_NaN());
    if (share == 0.0) return known.states[state_];
    return (1.0 - share) * known.states[state_] + share * known.states[state_ + 1];
  }

  /// A north that the run found late applies from the first frame on.
  void describeNorth(double share, FrameEstimate* refined) const {
    const MagnetometerEstimate& last = record_.frames().back().magnetometer;
    if (!last.north_found) return;
    MagnetometerEstimate& magnetometer = refined->magnetometer;
    magnetometer.heading_reference = last.heading_reference;
    magnetometer.declination_sigma_rad = last.declination_sigma_rad;
    magnetometer.axes_sigma_rad = last.axes_sigma_rad;
    magnetometer.north_found = last.north_found;
    magnetometer.north_from_world_rad = last.north_from_world_rad;
    AzimuthCovariance azimuth, posterior;
    posterior.variance_rad2 = azimuth.variance_rad2 = std::pow(last.north_from_world_sigma_rad, 2);
    const MagnetometerStates states(problem_.window());
    if (states.field) {
      magnetometer.field_W = states.field_W();
      magnetometer.north_from_world_rad =
          northFromWorld(states.field_W(), last.heading_reference, options_.magnetometer);
      if (!reported_.empty()) azimuth = azimuthAt(reported_, share);
      if (!posterior_.empty()) posterior = azimuthAt(posterior_, share);
    }
    magnetometer.north_from_world_sigma_rad = std::sqrt(azimuth.variance_rad2);
    relateToNorth(refined->state, azimuth, &refined->covariance);
    relateToNorth(refined->state, posterior, &refined->posterior_covariance);
  }

  AzimuthCovariance azimuthAt(const BatchCovariances& known, double share) const {
    AzimuthCovariance at = known.azimuths[state_];
    if (share > 0.0) at.with_state += share * (known.azimuths[state_ + 1].with_state - at.with_state);
    return at;
  }

  void describeMagnetometer(FrameEstimate* refined) const {
    const MagnetometerStates states(problem_.window());
    if (states.field == nullptr || !refined->magnetometer.field_W) return;
    refined->magnetometer.field_W = states.field_W();
    refined->magnetometer.offset_B = Vec3(problem_.walkingValue(MagnetometerStates::kOffset, state_));
  }

  void describeDepth(FrameEstimate* refined) const {
    const DepthStates states(problem_.window());
    if (!states || !refined->depth.gauge) return;
    DepthEstimate::Gauge& gauge = *refined->depth.gauge;
    gauge.depth_at_origin_m = *problem_.walkingValue(DepthStates::kOffset, state_);
    gauge.density_ratio = states.density_ratio();
    gauge.lag_s = states.lag_s();
    gauge.body_depth_m =
        gauge.depth_at_origin_m - gauge.density_ratio * refined->state.world_from_body.translation.z();
  }

  const BatchProblem& problem_;
  const Rig& rig_;
  const EstimatorOptions& options_;
  const EstimatorLog& record_;
  CovarianceInflation covariance_inflation_;
  const BatchCovariances& posterior_;
  const BatchCovariances& reported_;
  size_t state_ = 0;  ///< the last one at or before the frame
};

}  // namespace

BatchCovariances covariancesOf(const BatchProblem& problem, const BlockSkylineCholesky& inverse) {
  BatchCovariances covariances;
  for (size_t k = 0; k < problem.states(); ++k) {
    covariances.states.push_back(problem.covarianceOf(k, inverse));
    covariances.azimuths.push_back(problem.azimuth(k, inverse));
  }
  return covariances;
}

std::vector<FrameEstimate> refinedFrames(const BatchProblem& problem, const Rig& rig,
                                         const EstimatorOptions& options, const EstimatorLog& record,
                                         const BatchCovariances& posterior,
                                         const BatchCovariances& reported) {
  FrameMaker maker(problem, rig, options, record, posterior, reported);
  std::vector<FrameEstimate> frames;
  for (const FrameEstimate& forward : record.frames()) frames.push_back(maker.make(forward));
  return frames;
}

}  // namespace lodeline
