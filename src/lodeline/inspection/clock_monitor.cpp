#include "lodeline/inspection/clock_monitor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/inspection/inspection.h"
#include "lodeline/inspection/survey/visual_rotation.h"

namespace lodeline {
namespace {

/// Interval between the images of one rotation: long enough for a rotation above the noise of the points.
constexpr double kTurn_s = 0.12;
/// A rotation over a longer interval is not accurate enough in time.
constexpr double kLongestTurn_s = 0.3;
constexpr size_t kMostPoints = 60;
constexpr int kLeastPoints = 20;

/// Time span of a comparison, and interval between comparisons.
constexpr double kComparedWindow_s = 4.6;
constexpr double kBetweenComparisons_s = 1.5;
/// Margin of readings around the rotations, for offsets of both signs.
constexpr double kMargin_s = 1.0;

/// With a smaller correlation the offset is not reliable.
constexpr double kLeastCorrelation = 0.93;
/// The estimator compensates smaller offsets by itself.
constexpr double kLeastOffset_s = 0.015;
constexpr double kSignificant_sigmas = 5.0;
/// Two comparisons agree on an offset within this difference.
constexpr double kSame_s = 0.010;

}  // namespace

ClockMonitor::ClockMonitor(const Rig& rig)
    : camera_(rig.cameras.front().name), body_from_camera_(rig.cameras.front().body_from_camera.rotation) {}

std::optional<double> ClockMonitor::add(const FrameTracks& tracks, std::span<const ImuSample> imu,
                                        Diagnostics* diagnostics) {
  for (const ImuSample& sample : imu) {
    if (imu_.empty() || sample.time > imu_.back().time) imu_.push_back(sample);
  }
  forget(tracks.time);
  const double since_s = rays_time_ ? (tracks.time - *rays_time_).seconds() : kLongestTurn_s;
  if (since_s < kTurn_s) return std::nullopt;
  if (since_s < kLongestTurn_s) addTurn(tracks);
  rays_.clear();
  rays_time_ = tracks.time;
  for (const FeatureObservation& observation : tracks.observations) {
    if (observation.camera == 0) rays_[observation.track] = observation.bearing_C;
  }
  if (!next_comparison_) next_comparison_ = tracks.time + Duration::fromSeconds(kComparedWindow_s);
  if (tracks.time < *next_comparison_) return std::nullopt;
  next_comparison_ = tracks.time + Duration::fromSeconds(kBetweenComparisons_s);
  return compare(tracks.time, diagnostics);
}

void ClockMonitor::move(double by_s) {
  turns_.clear();
  rays_time_.reset();
  suspected_s_.reset();
  if (offset_s_) *offset_s_ -= by_s;
}

void ClockMonitor::addTurn(const FrameTracks& tracks) {
  std::vector<Vec3> previous, current;
  for (const FeatureObservation& observation : tracks.observations) {
    if (observation.camera != 0) continue;
    const auto before = rays_.find(observation.track);
    if (before == rays_.end()) continue;
    previous.push_back(before->second);
    current.push_back(observation.bearing_C);
  }
  // Every n-th point: neighbours in the list are of similar age, so their positions are distributed over the
  // image.
  const size_t every = std::max<size_t>(1, previous.size() / kMostPoints);
  std::vector<Vec3> some_previous, some_current;
  for (size_t i = 0; i < previous.size(); i += every) {
    some_previous.push_back(previous[i]);
    some_current.push_back(current[i]);
  }
  const std::optional<VisualRotation> turn = visualRotation(some_previous, some_current, kLeastPoints);
  if (!turn) return;
  const double length_s = (tracks.time - *rays_time_).seconds();
  turns_.push_back({*rays_time_, tracks.time, turn->rotation_C / length_s});
}

void ClockMonitor::forget(Time now) {
  const Time oldest_turn = now - Duration::fromSeconds(kComparedWindow_s);
  const Time oldest_reading = oldest_turn - Duration::fromSeconds(kMargin_s);
  while (!turns_.empty() && turns_.front().begin < oldest_turn) turns_.pop_front();
  while (!imu_.empty() && imu_.front().time < oldest_reading) imu_.pop_front();
}

/// Fast test: with the last offset, the gyroscope explains the rotations, and the errors do not correlate
/// with its changes.
bool ClockMonitor::keepTogether(const GyroscopeIntegral& gyroscope) const {
  constexpr double kStep_s = 5e-3;
  constexpr double kExplained = 0.95;
  std::vector<Vec3> errors, seen, changes;
  Vec3 mean_error = Vec3::Zero(), mean_seen = Vec3::Zero();
  for (const CameraTurn& turn : turns_) {
    const double begin_s = (turn.begin - gyroscope.origin()).seconds() + offset_s_.value_or(0.0);
    const double end_s = (turn.end - gyroscope.origin()).seconds() + offset_s_.value_or(0.0);
    const std::optional<Vec3> rate = gyroscope.meanRate_B(begin_s, end_s);
    const std::optional<Vec3> before = gyroscope.meanRate_B(begin_s - kStep_s, end_s - kStep_s);
    const std::optional<Vec3> after = gyroscope.meanRate_B(begin_s + kStep_s, end_s + kStep_s);
    if (!rate || !before || !after) continue;
    seen.push_back(body_from_camera_ * turn.rate_C);
    errors.push_back(seen.back() - *rate);
    changes.push_back((*after - *before) / (2.0 * kStep_s));
    mean_error += errors.back();
    mean_seen += seen.back();
  }
  const auto count = static_cast<double>(std::max<size_t>(1, errors.size()));
  double error = 0.0, size = 0.0, along = 0.0, change = 0.0;
  for (size_t i = 0; i < errors.size(); ++i) {
    error += (errors[i] - mean_error / count).squaredNorm();
    size += (seen[i] - mean_seen / count).squaredNorm();
    along += changes[i].dot(errors[i] - mean_error / count);
    change += changes[i].squaredNorm();
  }
  return error < (1.0 - kExplained) * size && std::abs(along) < 0.5 * kLeastOffset_s * change;
}

std::optional<double> ClockMonitor::compare(Time now, Diagnostics* diagnostics) {
  const std::vector<ImuSample> samples(imu_.begin(), imu_.end());
  const GyroscopeIntegral gyroscope(samples);
  if (keepTogether(gyroscope)) {
    suspected_s_.reset();
    return std::nullopt;
  }
  const std::optional<TurnComparison> comparison =
      compareTurns({turns_.begin(), turns_.end()}, gyroscope, body_from_camera_);
  if (!comparison || comparison->correlation < kLeastCorrelation) return std::nullopt;
  const double offset_s = comparison->time_offset_s;
  const double sigma_s = comparison->time_offset_sigma_s;
  const double change_s = offset_s - offset_s_.value_or(0.0);
  const bool is_off =
      std::abs(change_s) > kLeastOffset_s && std::abs(change_s) > kSignificant_sigmas * sigma_s;
  const bool is_confirmed = is_off && suspected_s_ && std::abs(*suspected_s_ - offset_s) < kSame_s;
  suspected_s_ = is_off ? std::optional(offset_s) : std::nullopt;
  if (!is_confirmed) return std::nullopt;
  report(now, offset_s, sigma_s, diagnostics);
  return offset_s;
}

void ClockMonitor::report(Time now, double offset_s, double sigma_s, Diagnostics* diagnostics) {
  const std::string where = fmt::format(
      "in the {:g} s before {} ns the stamps of the images of {} {} the gyroscope by {:.0f} ms "
      "(+-{:.1f})",
      kComparedWindow_s + kBetweenComparisons_s, now.nanoseconds(), camera_,
      offset_s < 0.0 ? "lag behind" : "run ahead of", 1e3 * std::abs(offset_s), 1e3 * sigma_s);
  if (!offset_s_) {
    diagnostics->report(
        Severity::Serious, kCameraTimeOffset,
        where +
            ", far more than a calibration leaves: a wrong timeshift_cam_imu, images stamped on arrival, or "
            "a "
            "clock that jumped; `lodeline inspect` tells which. Positions and attitudes are worse than their "
            "uncertainty says");
  } else {
    diagnostics->report(
        Severity::Serious, "camera_clock_jump",
        fmt::format(
            "{}, after {:.0f} ms before: a clock jumped. No single timeshift_cam_imu is right for this "
            "recording",
            where, 1e3 * std::abs(*offset_s_)));
  }
  offset_s_ = offset_s;
}

}  // namespace lodeline
