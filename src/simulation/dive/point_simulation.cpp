#include "simulation/dive/point_simulation.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace lodeline {
namespace {

ImuSample interpolated(const ImuSample& a, const ImuSample& b, Time time) {
  const double u = (time - a.time).seconds() / (b.time - a.time).seconds();
  return {time, (1.0 - u) * a.angular_velocity_B + u * b.angular_velocity_B,
          (1.0 - u) * a.specific_force_B + u * b.specific_force_B};
}

std::vector<std::shared_ptr<const Camera>> makeCameras(const Rig& rig) {
  std::vector<std::shared_ptr<const Camera>> cameras;
  for (const CameraCalibration& calibration : rig.cameras) cameras.push_back(makeCamera(calibration));
  return cameras;
}

/// Strength of a point for a detector: a hash of its index (finalizer of splitmix64).
uint64_t strengthOf(int point) {
  uint64_t hash = static_cast<uint64_t>(point) + 0x9e3779b97f4a7c15ull;
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
  return hash ^ (hash >> 31);
}

}  // namespace

PointSimulation::PointSimulation(const Motion& motion, const LandmarkField& landmarks, const Rig& rig,
                                 const PointSimulationOptions& options)
    : PointSimulation(motion, landmarks, rig, rig, options) {}

PointSimulation::PointSimulation(const Motion& motion, const LandmarkField& landmarks, const Rig& true_rig,
                                 const Rig& given_rig, const PointSimulationOptions& options)
    : motion_(motion),
      landmarks_(landmarks),
      true_rig_(true_rig),
      options_(options),
      true_cameras_(makeCameras(true_rig)),
      given_cameras_(makeCameras(given_rig)),
      imu_(options.imu, true_rig.imu.rate_hz, options.seed),
      pixel_noise_(options.seed, "points/pixel"),
      choice_(options.seed, "points/choice") {
  if (options.magnetometer) {
    const PointMagnetometer& magnetometer = *options.magnetometer;
    magnetometer_.emplace(motion, magnetometer.field_W, magnetometer.disturbances, magnetometer.errors,
                          true_rig.magnetometer.value().rate_hz, options.seed);
  }
  if (!options.vehicle) return;
  const PointVehicle& vehicle = *options.vehicle;
  if (vehicle.range && true_rig.dvl) {
    dvl_.emplace(motion, true_rig.dvl->body_from_dvl, true_rig.dvl->beams_D, vehicle.range, vehicle.dvl,
                 options.seed);
  }
  if (vehicle.range && true_rig.altimeter) {
    altimeter_.emplace(motion, true_rig.altimeter->body_from_sonar, vehicle.range, vehicle.altimeter,
                       options.seed, "altimeter");
  }
  if (vehicle.loads && true_rig.currents)
    currents_.emplace(vehicle.loads, vehicle.current_sensor, options.seed);
}

std::optional<SimulatedFrame> PointSimulation::next() {
  while (choice_.chance(options_.dropped_frame_share) && next_frame_ > 0) ++next_frame_;
  const double time_s = secondsOf(next_frame_++);
  if (time_s > std::min(options_.end_s, motion_.duration_s())) return std::nullopt;

  SimulatedFrame frame;
  frame.truth.time = options_.start + Duration::fromSeconds(time_s);
  frame.truth.motion = motion_.at(time_s);
  frame.tracks.time = frame.truth.time;
  takeImu(frame);
  takeMagnetometer(frame);
  takeVehicle(frame);

  const bool dark = std::any_of(options_.blackouts.begin(), options_.blackouts.end(),
                                [&](const MotionInterval& span) { return span.contains(time_s); });
  if (dark) {
    tracks_.clear();
  } else {
    renewTracks(time_s, frame.truth.motion.world_from_body);
    observe(frame.truth.motion.world_from_body, frame.tracks);
  }
  return frame;
}

void PointSimulation::takeImu(SimulatedFrame& frame) {
  const Time border = frame.truth.time;
  if (border_) frame.imu.push_back(*border_);
  const auto keep = [&](const Reading& reading) {
    if (frame.imu.empty() || reading.sample.time > frame.imu.back().time) frame.imu.push_back(reading.sample);
  };
  // A reading drawn after the last border is the first one of this interval.
  if (after_ && after_->sample.time <= border) {
    keep(*after_);
    before_ = after_;
    after_.reset();
  }
  while (!after_) {
    const double t = static_cast<double>(next_imu_++) / true_rig_.imu.rate_hz;
    const Time stamp = options_.start + Duration::fromSeconds(t);
    ImuSample perfect = perfectImuSample(motion_.at(t), stamp, options_.gravity_W);
    if (options_.vehicle && options_.vehicle->shake) options_.vehicle->shake(t, &perfect);
    const ImuSample sample = imu_.measure(perfect);
    const Reading reading{sample, imu_.gyroscopeBias(), imu_.accelerometerBias()};
    if (stamp <= border) {
      keep(reading);
      before_ = reading;
    } else {
      after_ = reading;
    }
  }
  if (before_ && frame.imu.back().time < border) {
    frame.imu.push_back(interpolated(before_->sample, after_->sample, border));
  }
  border_ = frame.imu.back();
  frame.truth.gyroscope_bias_B = before_->gyroscope_bias;
  frame.truth.accelerometer_bias_B = before_->accelerometer_bias;
}

void PointSimulation::takeMagnetometer(SimulatedFrame& frame) {
  while (magnetometer_) {
    const double t = static_cast<double>(next_magnetometer_) / true_rig_.magnetometer->rate_hz;
    const Time stamp = options_.start + Duration::fromSeconds(t);
    if (stamp > frame.truth.time) return;
    frame.magnetometer.push_back({stamp, magnetometer_->measure(t)});
    ++next_magnetometer_;
  }
}

void PointSimulation::takeVehicle(SimulatedFrame& frame) {
  // Reads a sensor up to the frame; `phase` is the place of its readings between those of the IMU.
  const auto take = [&](double rate_hz, double phase, int64_t* next, const auto& read) {
    for (;; ++*next) {
      const double t = (static_cast<double>(*next) + phase) / rate_hz;
      const Time stamp = options_.start + Duration::fromSeconds(t);
      if (stamp > frame.truth.time) return;
      read(t, stamp);
    }
  };
  if (dvl_) {
    take(true_rig_.dvl->rate_hz, 0.4, &next_dvl_, [&](double t, Time stamp) {
      frame.dvl.push_back(dvl_->measure(t));
      frame.dvl.back().time = stamp;
    });
  }
  if (altimeter_) {
    take(true_rig_.altimeter->rate_hz, 0.6, &next_altimeter_, [&](double t, Time stamp) {
      if (const auto echo = altimeter_->measure(t)) frame.altimeter.push_back({stamp, echo->range_m});
    });
  }
  if (currents_) {
    take(true_rig_.currents->rate_hz, 0.2, &next_currents_, [&](double t, Time stamp) {
      frame.currents.push_back({stamp, currents_->measure(t)});
    });
  }
}

std::optional<Vec2> PointSimulation::seen(int camera, const Rigid3& world_from_body,
                                          const LandmarkPoint& point) const {
  constexpr double kBorder_px = 4.0;
  const Rigid3 world_from_camera = world_from_body * true_rig_.cameras[camera].body_from_camera;
  const Vec3 ray_W = point.position_W - world_from_camera.translation;
  const double range_m = ray_W.norm();
  if (range_m < options_.nearest_m || range_m > options_.farthest_m) return std::nullopt;
  // A surface at grazing incidence cannot be tracked; from behind, it is not visible.
  if (ray_W.dot(point.normal_W) > -0.1 * range_m) return std::nullopt;
  const Vec3 point_C = world_from_camera.rotation.conjugate() * ray_W;
  const auto pixel = true_cameras_[camera]->project(point_C);
  if (!pixel || !true_cameras_[camera]->contains(*pixel, kBorder_px)) return std::nullopt;
  return pixel;
}

void PointSimulation::renewTracks(double time_s, const Rigid3& world_from_body) {
  std::erase_if(tracks_, [&](const Track& track) {
    return time_s - track.born_s > options_.longest_track_s ||
           !seen(0, world_from_body, landmarks_.points()[track.point]);
  });
  // Like a front end, detects new features when 10 % of the tracks are missing.
  if (static_cast<int>(tracks_.size()) * 10 >= options_.tracks * 9) return;
  std::set<int> taken;
  for (const Track& track : tracks_) taken.insert(track.point);
  std::vector<int> candidates = landmarks_.near(world_from_body.translation, options_.farthest_m);
  if (options_.strongest_first) {
    std::sort(candidates.begin(), candidates.end(),
              [](int a, int b) { return std::pair(strengthOf(a), a) < std::pair(strengthOf(b), b); });
  }
  while (static_cast<int>(tracks_.size()) < options_.tracks && !candidates.empty()) {
    if (!options_.strongest_first) {
      const int pick = choice_.index(static_cast<int>(candidates.size()));
      std::swap(candidates[pick], candidates.back());
    }
    const int point = candidates.back();
    candidates.pop_back();
    if (taken.count(point) || !seen(0, world_from_body, landmarks_.points()[point])) continue;
    tracks_.push_back({static_cast<TrackId>(point_of_track_.size()), point, time_s});
    point_of_track_.push_back(point);
  }
}

void PointSimulation::observe(const Rigid3& world_from_body, FrameTracks& tracks) {
  // Tracks are in the order of their identities, because new ones are appended.
  for (const Track& track : tracks_) {
    const LandmarkPoint& point = landmarks_.points()[track.point];
    for (int camera = 0; camera < static_cast<int>(true_cameras_.size()); ++camera) {
      if (camera > 0 && !choice_.chance(options_.stereo_share)) continue;
      const auto pixel = seen(camera, world_from_body, point);
      if (pixel) addObservation(track.id, camera, *pixel, tracks);
    }
  }
}

void PointSimulation::addObservation(TrackId track, int camera, const Vec2& true_pixel, FrameTracks& tracks) {
  const double x = pixel_noise_.normal();
  const double y = pixel_noise_.normal();
  Vec2 pixel = true_pixel + options_.pixel_sigma_px * Vec2(x, y);
  if (options_.outlier_share > 0.0 && pixel_noise_.chance(options_.outlier_share)) {
    const double angle = pixel_noise_.uniform(0.0, 6.283185307179586);
    pixel += pixel_noise_.uniform(5.0, 50.0) * Vec2(std::cos(angle), std::sin(angle));
  }
  const auto ray = given_cameras_[camera]->viewRay(pixel);
  if (!ray) return;
  FeatureObservation observation;
  observation.track = track;
  observation.camera = camera;
  observation.pixel = pixel;
  observation.bearing_C = ray->direction_C;
  observation.origin_C = ray->fromNearestPoint().origin_C;
  observation.sigma_px = std::max(options_.pixel_sigma_px, 1e-3);
  tracks.observations.push_back(observation);
}

}  // namespace lodeline
