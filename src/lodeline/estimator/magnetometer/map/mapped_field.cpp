#include "lodeline/estimator/magnetometer/map/mapped_field.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodeline/estimator/magnetometer/map/mapped_field_measurement.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

// Least distance of readings that are learnt, and greatest number that wait.
constexpr double kSpacing_m = 0.25;
constexpr size_t kMostWaiting = 1000;
// What the basis functions leave of the field of near steel, and what the position in a frame leaves.
constexpr double kMapFloor_T = 0.2e-6;
constexpr double kPositionFloor_m = 0.1;
// Path over which errors of the map stay equal: the map's own, and the drift of heading in the first pass.
constexpr double kMapCorrelation_m = 1.5, kDriftCorrelation_m = 20.0;
constexpr double kSmallestHorizontal_T = 5e-6;
constexpr double kMaxChiSquared = 14.2;  // 3 degrees of freedom, 3 sigma
constexpr double kAnchorSigma_rad = 1e-4;

/// Factor on the variance of an error that stays equal over a path, with which readings `step_m` apart can be
/// treated as independent.
double correlatedShareOverPath(double step_m, double correlation_m) {
  return 2.0 * correlation_m / std::clamp(step_m, 1e-3, 2.0 * correlation_m);
}

Vec3 aboutVertical(double angle_rad, const Vec3& vector) {
  return Eigen::AngleAxisd(angle_rad, Vec3::UnitZ()) * vector;
}

bool isSettled(const Frame* frame) { return frame == nullptr || !frame->has_motion; }

}  // namespace

void MappedField::remember(const JointCovariance& covariance, const Window& window) {
  const ParameterBlock* heading = window.findGlobal(MappedFieldMeasurement::kHeading);
  const double* pose = window.newest().pose.data();
  if (heading == nullptr || !covariance.knows(heading->value.data()) || !covariance.knows(pose)) return;
  const Eigen::Matrix<double, 15, 15> newest = covariance.newest();
  const double* map = heading->value.data();
  FieldMapOrigin known;
  known.time = window.newest().time;
  known.heading_variance_rad2 = std::max(
      0.0, newest(5, 5) - 2.0 * covariance.between(pose, map)(5, 0) + covariance.between(map, map)(0, 0));
  known.position_variance_m2 = newest.topLeftCorner<3, 3>().trace() / 3.0;
  known_ = known;
}

void MappedField::begin(const Reading& reading, Window& window) {
  map_.emplace(FieldMapOptions());
  earth_M_ = reading.earth_W;
  window.add({MappedFieldMeasurement::kHeading, {0.0}, std::nullopt, 0.0, true});
  // A reading of a horizontal unit vector that is known exactly: the map's heading is that of this frame.
  MappedFieldMeasurement anchor;
  anchor.mapped_M = Vec3::UnitX();
  anchor.reading_B = window.newest().worldFromBody().rotation.conjugate() * anchor.mapped_M;
  anchor.covariance_W = kAnchorSigma_rad * kAnchorSigma_rad * Mat3::Identity();
  window.newest().measurements.set(std::move(anchor));
  diagnostics_->report(
      Severity::Notice, "magnetic_map_begun",
      fmt::format("magnetometer: from {} ns on the field is mapped where it is not the Earth's",
                  reading.time.nanoseconds()));
}

bool MappedField::take(const Reading& reading, bool may_learn, Window& window) {
  if (!is_wanted_) return false;
  if (!map_) {
    if (may_learn) begin(reading, window);
    return false;
  }
  if (use(reading, window)) return true;
  if (may_learn) await(reading, window);
  return false;
}

void MappedField::await(const Reading& reading, const Window& window) {
  const Frame& newest = window.newest();
  const Rigid3 world_from_body = newest.worldFromBody();
  const bool is_near = last_learnt_W_ && (world_from_body.translation - *last_learnt_W_).norm() < kSpacing_m;
  if (!known_ || is_near || waiting_.size() >= kMostWaiting) return;
  last_learnt_W_ = world_from_body.translation;
  waiting_.push_back({newest.id, world_from_body, reading, *known_});
}

void MappedField::learnSettled(const Window& window) {
  if (waiting_.empty()) return;
  const ParameterBlock* heading = window.findGlobal(MappedFieldMeasurement::kHeading);
  std::erase_if(waiting_, [&](Waiting& waiting) {
    const Frame* frame = window.find(waiting.frame);
    if (frame != nullptr) waiting.world_from_body = frame->worldFromBody();
    if (!isSettled(frame)) return false;
    if (heading != nullptr) learn(waiting, heading->value[0]);
    return true;
  });
}

void MappedField::learn(const Waiting& waiting, double heading_rad) {
  const Reading& reading = waiting.reading;
  const Vec3 field_M = aboutVertical(-heading_rad, waiting.world_from_body.rotation * reading.field_B);
  FieldNoise noise;
  noise.sigma_T = std::sqrt(reading.variance_T2 + kMapFloor_T * kMapFloor_T);
  noise.tilt_sigma_rad = reading.tilt_sigma_rad;
  map_->learn(waiting.world_from_body.translation, field_M - earth_M_, fieldCovariance_W(field_M, noise),
              waiting.origin);
}

bool MappedField::use(const Reading& reading, Window& window) {
  const ParameterBlock* heading = window.findGlobal(MappedFieldMeasurement::kHeading);
  Frame& newest = window.newest();
  const Vec3 place_W = newest.worldFromBody().translation;
  if (heading == nullptr || !known_) return false;
  const std::optional<FieldMapPrediction> mapped = map_->predict(place_W);
  if (!mapped || (reading.time - mapped->last_reading).seconds() < kAway_s) return false;

  const Vec3 mapped_M = earth_M_ + mapped->anomaly.field;
  const Vec3 mapped_W = aboutVertical(heading->value[0], mapped_M);
  const double horizontal_T = mapped_W.head<2>().norm();
  if (horizontal_T < kSmallestHorizontal_T) return false;
  const double drift_m2 = kPositionFloor_m * kPositionFloor_m +
                          std::max(0.0, known_->position_variance_m2 - mapped->position_variance_m2);
  const Vec3 by_heading = Vec3::UnitZ().cross(mapped_W);
  const Mat3 of_map = mapped->anomaly.covariance +
                      drift_m2 * mapped->anomaly.by_place * mapped->anomaly.by_place.transpose() +
                      kMapFloor_T * kMapFloor_T * Mat3::Identity();
  const Mat3 of_drift = mapped->heading_variance_rad2 * by_heading * by_heading.transpose();
  FieldNoise noise;
  noise.sigma_T = std::sqrt(reading.variance_T2);
  noise.tilt_sigma_rad = reading.tilt_sigma_rad;
  const Mat3 of_reading = fieldCovariance_W(mapped_W, noise);

  const Vec3 across = by_heading / horizontal_T;
  const double heading_sigma_rad = std::sqrt(across.dot((of_map + of_reading) * across)) / horizontal_T;
  if (!(heading_sigma_rad < kMaxHeadingSigma_rad)) return false;
  const Vec3 difference_W = newest.worldFromBody().rotation * reading.field_B - mapped_W;
  const Mat3 expected =
      of_map + of_drift + of_reading + known_->heading_variance_rad2 * by_heading * by_heading.transpose();
  if (difference_W.dot(expected.llt().solve(difference_W)) > kMaxChiSquared) {
    contradict(place_W);
    return false;
  }
  contradictions_ = 0;
  const double step_m = last_used_W_ ? (place_W - *last_used_W_).norm() : 1e3;
  last_used_W_ = place_W;
  MappedFieldMeasurement measurement;
  measurement.reading_B = reading.field_B;
  measurement.mapped_M = mapped_M;
  measurement.covariance_W = correlatedShareOverPath(step_m, kMapCorrelation_m) * of_map +
                             correlatedShareOverPath(step_m, kDriftCorrelation_m) * of_drift + of_reading;
  newest.measurements.set(std::move(measurement));
  if (used_++ == 0) {
    diagnostics_->report(
        Severity::Notice, "magnetic_map_used",
        fmt::format(
            "magnetometer: from {} ns on the map of the field gives heading where the rig has been before "
            "({:.1f} degrees by one reading)",
            reading.time.nanoseconds(), heading_sigma_rad * kDegreesPerRadian));
  }
  return true;
}

void MappedField::contradict(const Vec3& place_W) {
  if (++contradictions_ < kContradictions) return;
  contradictions_ = 0;
  map_->forget(place_W);
}

}  // namespace lodeline
