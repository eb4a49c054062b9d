#include "lodeline/estimator/rest_watch.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

/// Readings may stray from their means by five sigmas of white noise on top of what the options say.
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

double median(std::vector<double>* values) {
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace

RestWatch::RestWatch(const Rig& rig, const RestOptions& options)
    : options_(options),
      focal_length_px_(rig.cameras.empty() ? 0.0 : rig.cameras.front().fx_px),
      readings_(detectorOptions(rig.imu, options)) {}

bool RestWatch::add(const FrameTracks& tracks, std::span<const ImuSample> imu) {
  const bool readings_rest = readingsRest(imu);
  Picture picture{tracks.time, {}};
  for (const Observation& observation : tracks.observations) {
    if (observation.camera == 0) picture.points.push_back({observation.track, observation.bearing_C});
  }
  pictures_.push_back(std::move(picture));
  // The oldest one that stays is the newest that is `span_s` old.
  while (pictures_.size() > 1 && (tracks.time - pictures_[1].time).seconds() >= options_.span_s)
    pictures_.pop_front();
  if (!options_.enabled || !readings_rest) return false;
  if (last_rest_ && (tracks.time - *last_rest_).seconds() < options_.span_s) return false;
  if (!imagesRest()) return false;
  last_rest_ = tracks.time;
  return true;
}

bool RestWatch::readingsRest(std::span<const ImuSample> imu) {
  bool rest = false;
  for (const ImuSample& sample : imu) {
    const double step_s = last_reading_ ? (sample.time - *last_reading_).seconds() : 0.0;
    // The last reading of one frame is the first of the next.
    if (last_reading_ && step_s <= 0.0) continue;
    last_reading_ = sample.time;
    rest = readings_.update(sample, step_s);
  }
  return rest;
}

bool RestWatch::imagesRest() const {
  const Picture &first = pictures_.front(), &last = pictures_.back();
  const Picture& middle = pictures_[pictures_.size() / 2];
  if ((last.time - first.time).seconds() < options_.span_s || pictures_.size() < 3) return false;
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
  if (static_cast<int>(shifts.size()) < options_.min_tracks) return false;
  // Noise shifts by sqrt(2) sigma and bends by sqrt(6) sigma, a steady motion only shifts.
  const double noise_shift = std::sqrt(2.0 / 6.0) * median(&bends);
  return median(&shifts) < std::max(options_.shift_px / focal_length_px_, 1.4 * noise_shift);
}

}  // namespace lodeline
