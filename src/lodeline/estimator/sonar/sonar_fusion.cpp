#include "lodeline/estimator/sonar/sonar_fusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

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

template <typename Sample>
EchoFusion<Sample>::EchoFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
    : options_(options.sonar), diagnostics_(diagnostics), scale_sigma_(options.sonar.greatest_scale_sigma) {
  if (!options_.use) return;
  sonar_ = EchoSource<Sample>::of(rig);
  if (!sonar_) return;
  options_.surface_angle_rad = std::max(options_.surface_angle_rad, 0.5 * sonar_->sensor.beam_width_rad);
  estimate_.status = SonarStatus::NoData;
}

template <typename Sample>
bool EchoFusion<Sample>::isValid(const RawEcho& echo) const {
  const double max_range_m = sonar_->sensor.max_range_m;
  const bool is_too_far = max_range_m > 0.0 && echo.range_m > max_range_m;
  return std::isfinite(echo.range_m) && echo.range_m > 0.0 && !is_too_far && echo.beam.axes_B.allFinite();
}

template <typename Sample>
void EchoFusion<Sample>::take(const SensorReadings& readings, std::span<const ImuSample>, const Vec3&) {
  waiting_.clear();
  if (!sonar_) return;
  std::vector<RawEcho> echoes;
  for (const Sample& sample : readings.of<Sample>()) sonar_->append(sample, &echoes);
  for (const RawEcho& echo : echoes) {
    if (isValid(echo)) {
      waiting_.push_back(echo);
      continue;
    }
    diagnostics_->report(
        Severity::Warning, EchoSource<Sample>::kInvalid,
        fmt::format("{}: at {} ns a range of {} m, or its angle, is no echo; such readings are left out. "
                    "Check the unit of its ranges, and max_range in its calibration",
                    EchoSource<Sample>::kName, echo.time.nanoseconds(), echo.range_m));
  }
}

template <typename Sample>
SonarEcho EchoFusion<Sample>::echoOf(const RawEcho& raw, const Frame& before, const Frame& newest) const {
  const double share = (raw.time - before.time).seconds() / (newest.time - before.time).seconds();
  const Rigid3 pose = poseBetween(before.state(), newest.state(), share);
  SonarEcho echo{raw.range_m,
                 options_.noise_inflation * sonar_->sensor.range_noise_std_m,
                 raw.beam,
                 PoseInterpolation(before.worldFromBody(), pose, newest.worldFromBody(), share),
                 newest.worldFromBody().inverse() * pose,
                 1.0};
  echo.share = timeCorrelatedShare(raw.time, last_used_, options_.correlated_noise_time_s);
  return echo;
}

template <typename Sample>
bool EchoFusion<Sample>::agrees(const SonarEcho& echo, const LocalSurface& surface) {
  const double sigma_m = std::hypot(echo.sigma_m, surface.sigma_m, scale_sigma_ * surface.range_m);
  const bool agrees = std::abs(echo.range_m - surface.range_m) < options_.max_sigmas * sigma_m;
  ++judged_;
  rejected_ += !agrees;
  return agrees;
}

template <typename Sample>
void EchoFusion<Sample>::addToNewest(Window& window, Marginalizer& marginalizer) {
  if (!sonar_) return;
  estimate_ = {SonarStatus::NoData};
  const Frame& newest = window.newest();
  Frame& before = **std::prev(window.frames().end(), 2);
  if (!before.has_motion) return;
  SonarMeasurement measurement;
  measurement.kind = name();
  measurement.options = options_;
  const auto isChosen = [&](const FeatureTrack& track) {
    const Frame* host = window.find(track.landmark->host);
    return host != nullptr && !host->interpolated;
  };
  for (const RawEcho& raw : waiting_) {
    if (raw.time <= before.time || raw.time > newest.time) continue;
    ++estimate_.echoes;
    const SonarEcho echo = echoOf(raw, before, newest);
    const Rigid3 pose = newest.worldFromBody() * echo.frame_from_echo;
    const auto surface = surfaceAlong(echo.beam, pose, window, marginalizer.factors(), options_, isChosen);
    if (!surface) {
      if (estimate_.status == SonarStatus::NoData) estimate_.status = SonarStatus::NoSurface;
      continue;
    }
    if (!agrees(echo, *surface)) {
      estimate_.status = SonarStatus::Rejected;
      reportRejections(raw.time);
      continue;
    }
    estimate_.innovation_m += echo.range_m - surface->range_m;
    last_used_ = raw.time;
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

template <typename Sample>
void EchoFusion<Sample>::reportRejections(Time time) {
  constexpr int kEnough = 50;
  constexpr double kMany = 0.5;
  if (is_rejection_reported_ || judged_ < kEnough || rejected_ < kMany * judged_) return;
  is_rejection_reported_ = true;
  diagnostics_->report(
      Severity::Warning, EchoSource<Sample>::kRejected,
      fmt::format("{}: up to {} ns {} of {} echoes disagree with the landmarks around their beams; they are "
                  "not used. Check the pose of the sonar in the calibration, the unit of its ranges and the "
                  "sign of its angle",
                  EchoSource<Sample>::kName, time.nanoseconds(), rejected_, judged_));
}

template <typename Sample>
void EchoFusion<Sample>::remember(const JointCovariance& covariance, Window& window) {
  if (!sonar_ || covariance.empty()) return;
  const double sigma = scaleUncertainty(window.newest(), covariance.newest());
  scale_sigma_ = std::isfinite(sigma)
                     ? std::clamp(sigma, options_.least_scale_sigma, options_.greatest_scale_sigma)
                     : options_.greatest_scale_sigma;
}

template <typename Sample>
void EchoFusion<Sample>::report(const Window&, SensorEstimates* estimates) const {
  estimates->set(estimate_);
}

template <typename Sample>
std::optional<SensorRow> EchoFusion<Sample>::row() const {
  if (!sonar_) return std::nullopt;
  const std::string prefix(name());
  const char* status = toString(estimate_.status);
  return SensorRow{prefix,
                   status,
                   {{prefix, status},
                    {prefix + "_echoes", fmt::format("{}", estimate_.echoes)},
                    {prefix + "_used", fmt::format("{}", estimate_.used)},
                    {prefix + "_innovation [m]", fmt::format("{:.9g}", estimate_.innovation_m)}}};
}

template class EchoFusion<SonarSample>;
template class EchoFusion<AltimeterSample>;
template class EchoFusion<DvlSample>;

}  // namespace lodeline
