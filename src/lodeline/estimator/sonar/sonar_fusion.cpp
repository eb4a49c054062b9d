#include "lodeline/estimator/sonar/sonar_fusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/estimator/uncertainty/time_correlated_error.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Pose between two states: the cubic through both positions with both velocities, and the shortest rotation.
Rigid3 poseBetween(const NavigationState& before, const NavigationState& after, double share) {
  const double interval_s = (after.time - before.time).seconds();
  const double s2 = share * share, s3 = s2 * share;
  const Vec3 position =
      (2.0 * s3 - 3.0 * s2 + 1.0) * before.world_from_body.translation +
      (3.0 * s2 - 2.0 * s3) * after.world_from_body.translation +
      interval_s * ((s3 - 2.0 * s2 + share) * before.velocity_W + (s3 - s2) * after.velocity_W);
  return {before.world_from_body.rotation.slerp(share, after.world_from_body.rotation), position};
}

}  // namespace

const char* toString(SonarStatus status) {
  switch (status) {
    case SonarStatus::Off:
      return "off";
    case SonarStatus::NoData:
      return "no_data";
    case SonarStatus::Used:
      return "used";
    case SonarStatus::NoSurface:
      return "no_surface";
    case SonarStatus::Rejected:
      return "rejected";
  }
  return "";
}

SonarFusion::SonarFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
    : options_(options.sonar), diagnostics_(diagnostics), scale_sigma_(options.sonar.greatest_scale_sigma) {
  if (!options_.use || !rig.sonar) return;
  sonar_ = rig.sonar;
  options_.surface_angle_rad = std::max(options_.surface_angle_rad, 0.5 * sonar_->beam_width_rad);
  estimate_.status = SonarStatus::NoData;
}

bool SonarFusion::isValid(const SonarSample& sample) const {
  const bool is_too_far = sonar_->max_range_m > 0.0 && sample.range_m > sonar_->max_range_m;
  return std::isfinite(sample.range_m) && sample.range_m > 0.0 && !is_too_far &&
         std::isfinite(sample.angle_rad);
}

void SonarFusion::take(const SensorReadings& readings, std::span<const ImuSample>, const Vec3&) {
  waiting_.clear();
  if (!sonar_) return;
  for (const SonarSample& sample : readings.of<SonarSample>()) {
    if (isValid(sample)) {
      waiting_.push_back(sample);
      continue;
    }
    diagnostics_->report(
        Severity::Warning, "sonar_invalid",
        fmt::format("sonar: at {} ns a range of {} m at {} rad is no echo; such readings are left out. "
                    "Check the unit of its ranges, and max_range in its calibration",
                    sample.time.nanoseconds(), sample.range_m, sample.angle_rad));
  }
}

SonarBeam SonarFusion::beamOf(const SonarSample& sample) const {
  const double c = std::cos(sample.angle_rad), s = std::sin(sample.angle_rad);
  Mat3 axes_S;
  axes_S << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return {sonar_->body_from_sonar.translation, sonar_->body_from_sonar.rotation.toRotationMatrix() * axes_S};
}

SonarEcho SonarFusion::echoOf(const SonarSample& sample, const Frame& before, const Frame& newest) const {
  const double share = (sample.time - before.time).seconds() / (newest.time - before.time).seconds();
  const Rigid3 pose = poseBetween(before.state(), newest.state(), share);
  SonarEcho echo{sample.range_m,
                 options_.noise_inflation * sonar_->range_noise_std_m,
                 beamOf(sample),
                 PoseInterpolation(before.worldFromBody(), pose, newest.worldFromBody(), share),
                 newest.worldFromBody().inverse() * pose,
                 1.0};
  echo.share = timeCorrelatedShare(sample.time, last_used_, options_.correlated_noise_time_s);
  return echo;
}

bool SonarFusion::agrees(const SonarEcho& echo, const LocalSurface& surface) {
  const double sigma_m = std::hypot(echo.sigma_m, surface.sigma_m, scale_sigma_ * surface.range_m);
  const bool agrees = std::abs(echo.range_m - surface.range_m) < options_.max_sigmas * sigma_m;
  ++judged_;
  rejected_ += !agrees;
  return agrees;
}

void SonarFusion::addToNewest(Window& window, Marginalizer& marginalizer) {
  if (!sonar_) return;
  estimate_ = {SonarStatus::NoData};
  const Frame& newest = window.newest();
  Frame& before = **std::prev(window.frames().end(), 2);
  if (!before.has_motion) return;
  SonarMeasurement measurement;
  measurement.options = options_;
  const auto isChosen = [&](const FeatureTrack& track) {
    const Frame* host = window.find(track.landmark->host);
    return host != nullptr && !host->interpolated;
  };
  for (const SonarSample& sample : waiting_) {
    if (sample.time <= before.time || sample.time > newest.time) continue;
    ++estimate_.echoes;
    const SonarEcho echo = echoOf(sample, before, newest);
    const Rigid3 pose = newest.worldFromBody() * echo.frame_from_echo;
    const auto surface = surfaceAlong(echo.beam, pose, window, marginalizer.factors(), options_, isChosen);
    if (!surface) {
      if (estimate_.status == SonarStatus::NoData) estimate_.status = SonarStatus::NoSurface;
      continue;
    }
    if (!agrees(echo, *surface)) {
      estimate_.status = SonarStatus::Rejected;
      reportRejections(sample.time);
      continue;
    }
    estimate_.innovation_m += echo.range_m - surface->range_m;
    last_used_ = sample.time;
    measurement.echoes.push_back(echo);
  }
  if (measurement.echoes.empty()) return;
  estimate_.innovation_m /= static_cast<double>(measurement.echoes.size());
  // Echoes of landmarks whose distances are not known yet make no factor, or make it later.
  estimate_.used = static_cast<int>(
      measurement.factors({marginalizer.factors(), window, &before, window.newest()}).size());
  estimate_.status = estimate_.used > 0 ? SonarStatus::Used : SonarStatus::NoSurface;
  window.newest().measurements.set(std::move(measurement));
}

void SonarFusion::reportRejections(Time time) {
  constexpr int kEnough = 50;
  constexpr double kMany = 0.5;
  if (is_rejection_reported_ || judged_ < kEnough || rejected_ < kMany * judged_) return;
  is_rejection_reported_ = true;
  diagnostics_->report(
      Severity::Warning, "sonar_rejected",
      fmt::format(
          "sonar: up to {} ns {} of {} echoes disagree with the landmarks around their beams; they are "
          "not used. Check the pose of the sonar in the calibration, the unit of its ranges and the "
          "sign of its angle",
          time.nanoseconds(), rejected_, judged_));
}

void SonarFusion::remember(const JointCovariance& covariance, Window& window) {
  if (!sonar_ || covariance.empty()) return;
  const double sigma = scaleUncertainty(window.newest(), covariance.newest());
  scale_sigma_ = std::isfinite(sigma)
                     ? std::clamp(sigma, options_.least_scale_sigma, options_.greatest_scale_sigma)
                     : options_.greatest_scale_sigma;
}

void SonarFusion::report(const Window&, SensorEstimates* estimates) const { estimates->set(estimate_); }

std::optional<SensorRow> SonarFusion::row() const {
  if (!sonar_) return std::nullopt;
  const char* status = toString(estimate_.status);
  return SensorRow{std::string(name()),
                   status,
                   {{"sonar", status},
                    {"sonar_echoes", fmt::format("{}", estimate_.echoes)},
                    {"sonar_used", fmt::format("{}", estimate_.used)},
                    {"sonar_innovation [m]", fmt::format("{:.9g}", estimate_.innovation_m)}}};
}

}  // namespace lodeline
