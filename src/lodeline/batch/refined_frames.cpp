#include "lodeline/batch/refined_frames.h"

#include <cmath>
#include <limits>

#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/estimator/pressure/depth_states.h"
#include "lodeline/estimator/uncertainty/covariance_inflation.h"
#include "lodeline/estimator/uncertainty/reported_covariance.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {
namespace {

using Mat15 = Eigen::Matrix<double, 15, 15>;

class FrameMaker {
 public:
  FrameMaker(const BatchProblem& problem, const Rig& rig, const EstimatorOptions& options,
             const EstimatorLog& record, const BatchCovariances& posterior, const BatchCovariances& reported,
             const StateErrors& removed)
      : problem_(problem),
        rig_(rig),
        options_(options),
        record_(record),
        covariance_inflation_(options),
        posterior_(posterior),
        reported_(reported),
        removed_(removed) {}

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
    describeCameras(&refined);
    refined.gyroscope_axes = gyroscopeAxes(problem_.window());
    refined.accelerometer_axes = accelerometerAxes(problem_.window());
    describeMagnetometer(&refined);
    describeDepth(&refined);
    covariance_inflation_.follow(refined.state.world_from_body, forward.scene_distance_m);
    MagnetometerEstimate& magnetometer = refined.sensors.of<MagnetometerEstimate>();
    inflate({rig_.cameras.size() > 1, refined.sensors.of<DepthEstimate>().unmodelledDensitySigma(),
             magnetometer.field_W.has_value(), !options_.imu_axes.areDoubted()},
            share, &refined.covariance);
    addHeadingError(magnetometer.axes_sigma_rad, refined.state, &refined.covariance);
    magnetometer.heading_sigma_rad =
        std::hypot(std::sqrt(refined.covariance(5, 5)), magnetometer.declination_sigma_rad);
    return refined;
  }

  /// Modelled errors of the last frame, without loops, and the state at or before it.
  const Eigen::MatrixXd& errors() const { return errors_; }
  size_t stateBefore() const { return state_; }

 private:
  void inflate(const EstimateSources& sources, double share, Mat15* covariance) {
    if (!is_with_loops_) {
      covariance_inflation_.addTo(sources, covariance);
      return;
    }
    errors_ = covariance_inflation_.root(sources);
    if (removed_.empty()) return;
    Eigen::MatrixXd left = errors_ - (1.0 - share) * removed_[state_];
    if (share > 0.0) left -= share * removed_[state_ + 1];
    covariance->topLeftCorner<6, 6>() += left * left.transpose();
  }

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
    const MagnetometerEstimate& last = record_.frames().back().sensors.of<MagnetometerEstimate>();
    if (!last.north_found) return;
    MagnetometerEstimate& magnetometer = refined->sensors.of<MagnetometerEstimate>();
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

  void describeCameras(FrameEstimate* refined) const {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    refined->camera_corrections = cameraCorrections(problem_.window());
    if (!refined->camera_corrections) return;
    std::vector<PortCorrection>& ports = refined->camera_corrections->ports;
    for (size_t i = 0; i < ports.size(); ++i) {
      ports[i].sigma = reported_.empty() ? Vec3::Constant(kUnknown) : reported_.port_sigmas[i];
      ports[i].is_dome = rig_.cameras[i].port && rig_.cameras[i].port->type == Port::Type::Dome;
    }
  }

  void describeMagnetometer(FrameEstimate* refined) const {
    const MagnetometerStates states(problem_.window());
    MagnetometerEstimate& magnetometer = refined->sensors.of<MagnetometerEstimate>();
    if (states.field == nullptr || !magnetometer.field_W) return;
    magnetometer.field_W = states.field_W();
    magnetometer.offset_B = Vec3(problem_.walkingValue(MagnetometerStates::kOffset, state_));
  }

  void describeDepth(FrameEstimate* refined) const {
    const DepthStates states(problem_.window());
    DepthEstimate& depth = refined->sensors.of<DepthEstimate>();
    if (!states || !depth.gauge) return;
    DepthEstimate::Gauge& gauge = *depth.gauge;
    gauge.depth_at_origin_m = *problem_.walkingValue(DepthStates::kOffset, state_);
    gauge.density_ratio = states.density_ratio();
    gauge.lag_s = states.lag_s();
    gauge.body_depth_m =
        gauge.depth_at_origin_m / gauge.density_ratio - refined->state.world_from_body.translation.z();
  }

  const BatchProblem& problem_;
  const Rig& rig_;
  const EstimatorOptions& options_;
  const EstimatorLog& record_;
  CovarianceInflation covariance_inflation_;
  const BatchCovariances& posterior_;
  const BatchCovariances& reported_;
  const StateErrors& removed_;
  bool is_with_loops_ = problem_.linksUsed() > 0;
  Eigen::MatrixXd errors_;
  size_t state_ = 0;  ///< the last one at or before the frame
};

}  // namespace

BatchCovariances covariancesOf(const BatchProblem& problem, const BlockSkylineCholesky& inverse) {
  BatchCovariances covariances;
  covariances.port_sigmas = problem.portSigmas(inverse);
  for (size_t k = 0; k < problem.states(); ++k) {
    covariances.states.push_back(problem.covarianceOf(k, inverse));
    covariances.azimuths.push_back(problem.azimuth(k, inverse));
  }
  return covariances;
}

StateErrors errorsAlongPath(const BatchProblem& problem, const Rig& rig, const EstimatorOptions& options,
                            const EstimatorLog& record) {
  const BatchCovariances unknown;
  const StateErrors none;
  FrameMaker maker(problem, rig, options, record, unknown, unknown, none);
  StateErrors errors(problem.states(), Eigen::MatrixXd::Zero(6, CovarianceInflation::kErrors));
  for (const FrameEstimate& forward : record.frames()) {
    const FrameEstimate frame = maker.make(forward);
    if (problem.state(maker.stateBefore()).time == frame.time) errors[maker.stateBefore()] = maker.errors();
  }
  return errors;
}

StateErrors errorsRemovedByLoops(BatchProblem& problem, const StateErrors& along_path,
                                 const BlockSkylineCholesky& factorized) {
  const Eigen::MatrixXd forces = problem.loopInformationTimes(along_path);
  StateErrors removed(problem.states(), Eigen::MatrixXd::Zero(6, forces.cols()));
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    if (forces.col(i).isZero(0.0)) continue;
    const Eigen::VectorXd change = factorized.solve(forces.col(i));
    for (size_t k = 0; k < problem.states(); ++k)
      removed[k].col(i) = change.segment<6>(problem.poseOffset(k, factorized));
  }
  return removed;
}

std::vector<FrameEstimate> refinedFrames(const BatchProblem& problem, const Rig& rig,
                                         const EstimatorOptions& options, const EstimatorLog& record,
                                         const BatchCovariances& posterior, const BatchCovariances& reported,
                                         const StateErrors& removed) {
  FrameMaker maker(problem, rig, options, record, posterior, reported, removed);
  std::vector<FrameEstimate> frames;
  for (const FrameEstimate& forward : record.frames()) frames.push_back(maker.make(forward));
  return frames;
}

}  // namespace lodeline
