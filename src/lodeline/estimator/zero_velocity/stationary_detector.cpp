#include "lodeline/estimator/zero_velocity/stationary_detector.h"

#include "lodeline/cameras/camera_model.h"
#include "lodeline/util/median.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

/// Options of the readings' detector. Deviations from the means may reach five sigmas of white noise in
/// addition to the options' limits.
RestDetectorOptions detectorOptions(const ImuCalibration& imu, const RestOptions& options) {
  constexpr double kSigmas = 5.0;
  const double per_density = kSigmas * std::sqrt(imu.rate_hz);
  RestDetectorOptions detector;
  detector.shortest_s = options.span_s;
  detector.rate_deviation_rad_per_s =
      options.rate_deviation_rad_per_s + per_density * imu.noise.gyroscope_density_rad_per_s_sqrtHz;
  detector.force_deviation_m_per_s2 =
      options.force_deviation_m_per_s2 + per_density * imu.noise.accelerometer_density_m_per_s2_sqrtHz;
  return detector;
}

}  // namespace

StationaryDetector::StationaryDetector(const Rig& rig, const RestOptions& options)
    : options_(options),
      noise_(rig.imu.noise),
      focal_length_px_(rig.cameras.empty() ? 0.0 : focalLengthOnAxis_px(rig.cameras.front())),
      readings_(detectorOptions(rig.imu, options)) {}

bool StationaryDetector::add(const FrameTracks& tracks, std::span<const ImuSample> imu) {
  Picture picture;
  picture.time = tracks.time;
  const bool readings_rest = readingsRest(imu, &picture);
  for (const FeatureObservation& observation : tracks.observations) {
    if (observation.camera == 0) picture.points.push_back({observation.track, observation.bearing_C});
  }
  pictures_.push_back(std::move(picture));
  // The oldest image kept is the newest one with an age of at least `span_s`.
  while (pictures_.size() > 1 && (tracks.time - pictures_[1].time).seconds() >= options_.span_s)
    pictures_.pop_front();
  if (!options_.enabled || !readings_rest) return false;
  if (last_rest_ && (tracks.time - *last_rest_).seconds() < options_.span_s) return false;
  const std::optional<double> shift_rad = shiftAtRest();
  if (!shift_rad) return false;
  learnBias(*shift_rad);
  last_rest_ = tracks.time;
  return true;
}

std::optional<GyroscopeAtRest> StationaryDetector::gyroscope() const {
  if (!last_rest_) return std::nullopt;
  // A gyroscope at rest also measures the Earth's rotation, whose direction in body axes changes with the
  // rig's attitude.
  constexpr double kEarth_rad_per_s = 7.292e-5;
  const double wander = noise_.gyroscope_random_walk_rad_per_s2_sqrtHz;
  const double since_s = (pictures_.back().time - *last_rest_).seconds();
  return GyroscopeAtRest{
      bias_B_, std::sqrt(bias_variance_ + wander * wander * since_s + kEarth_rad_per_s * kEarth_rad_per_s)};
}

void StationaryDetector::learnBias(double shift_rad) {
  Vec3 sum_of_rates = Vec3::Zero();
  int readings = 0;
  for (auto picture = pictures_.begin() + 1; picture != pictures_.end(); ++picture) {
    sum_of_rates += picture->sum_of_rates_B;
    readings += picture->readings;
  }
  if (readings == 0) return;
  const double span_s = (pictures_.back().time - pictures_.front().time).seconds();
  const double white = noise_.gyroscope_density_rad_per_s_sqrtHz, turn = shift_rad / span_s;
  const double variance = white * white / span_s + turn * turn;
  const double wander = noise_.gyroscope_random_walk_rad_per_s2_sqrtHz;
  const double since_s = last_rest_ ? (pictures_.back().time - *last_rest_).seconds() : 0.0;
  bias_variance_ += wander * wander * since_s;
  const double gain = last_rest_ ? bias_variance_ / (bias_variance_ + variance) : 1.0;
  bias_B_ += gain * (sum_of_rates / readings - bias_B_);
  bias_variance_ = last_rest_ ? (1.0 - gain) * bias_variance_ : variance;
}

bool StationaryDetector::readingsRest(std::span<const ImuSample> imu, Picture* picture) {
  bool rest = false;
  for (const ImuSample& sample : imu) {
    const double step_s = last_reading_ ? (sample.time - *last_reading_).seconds() : 0.0;
    // The last reading of one frame is the first of the next.
    if (last_reading_ && step_s <= 0.0) continue;
    last_reading_ = sample.time;
    picture->sum_of_rates_B += sample.angular_velocity_B;
    ++picture->readings;
    rest = readings_.update(sample, step_s);
  }
  return rest;
}

std::optional<double> StationaryDetector::shiftAtRest() const {
  const Picture &first = pictures_.front(), &last = pictures_.back();
  const Picture& middle = pictures_[pictures_.size() / 2];
  if ((last.time - first.time).seconds() < options_.span_s || pictures_.size() < 3) return std::nullopt;
  std::vector<double> shifts, bends;
  auto a = first.points.begin(), b = middle.points.begin();
  for (const Point& c : last.points) {
    while (a != first.points.end() && a->track < c.track) ++a;
    while (b != middle.points.end() && b->track < c.track) ++b;
    if (a == first.points.end() || b == middle.points.end()) break;
    if (a->track != c.track || b->track != c.track) continue;
    shifts.push_back((c.bearing_C - a->bearing_C).norm());
    bends.push_back((c.bearing_C - 2.0 * b->bearing_C + a->bearing_C).norm());
  }
  if (static_cast<int>(shifts.size()) < options_.min_tracks) return std::nullopt;
  // Noise gives a shift of sqrt(2) sigma and a second difference of sqrt(6) sigma; a steady motion gives only
  // a shift.
  const double noise_shift = std::sqrt(2.0 / 6.0) * median(bends);
  const double shift = median(shifts);
  if (shift >= std::max(options_.shift_px / focal_length_px_, 1.4 * noise_shift)) return std::nullopt;
  // The common shift of all tracks, after subtraction of the noise, plus the uncertainty of the median by
  // noise.
  const double of_all = std::max(shift * shift - noise_shift * noise_shift, 0.0);
  return std::sqrt(of_all + noise_shift * noise_shift / static_cast<double>(shifts.size()));
}

}  // namespace lodeline
