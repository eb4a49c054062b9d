#include "lodeline/estimator/monitoring/inertial_monitor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Limits that a rig which is carried, swims or flies does not exceed.
constexpr double kGreatestAcceleration_m_per_s2 = 15.0;
constexpr double kGreatestAngularAcceleration_rad_per_s2 = 15.0;

const Vec3& shorter(const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm() ? a : b; }

constexpr size_t kFewestValues = 5;

/// The rotation of the body takes an innovation from world axes to body axes, where the error of a sensor
/// lasts.
Innovation inBody(const Innovation& innovation_W, const Quat& world_from_body) {
  const Mat3 body_from_world = world_from_body.toRotationMatrix().transpose();
  const auto rotated = [&](const Mat3& covariance) -> Mat3 {
    return body_from_world * covariance * body_from_world.transpose();
  };
  return {body_from_world * innovation_W.value, rotated(innovation_W.covariance_of_new),
          rotated(innovation_W.covariance_of_lasting)};
}

}  // namespace

double InnovationWatch::meanNis() const {
  double sum = 0.0;
  for (const Value& value : values_) sum += value.nis;
  return sum / static_cast<double>(std::max(values_.size(), kFewestValues));
}

Innovation InnovationWatch::sum() const {
  Innovation sum{Vec3::Zero(), Mat3::Zero(), Mat3::Zero()};
  for (const Value& value : values_) {
    sum.value += value.innovation.value;
    sum.covariance_of_new += value.innovation.covariance_of_new;
    sum.covariance_of_lasting += value.innovation.covariance_of_lasting;
  }
  // Equal errors add up to n times one of them, and to n squared times its covariance.
  sum.covariance_of_lasting *= static_cast<double>(values_.size());
  return sum;
}

void InnovationWatch::add(Time time, const Innovation& innovation) {
  constexpr double kSpan_s = 0.5;
  constexpr double kGreatest = 4.0 * kBeyondChance;
  constexpr double kCalm_s = 1.0;
  const double nis = innovation.nis();
  Innovation limited = innovation;
  if (nis > kGreatest) limited.value *= std::sqrt(kGreatest / nis);
  values_.push_back({time, std::min(nis, kGreatest), limited});
  while (values_.size() > kFewestValues && (time - values_[1].time).seconds() >= kSpan_s) values_.pop_front();
  const bool is_sum_beyond_chance = sums_ && values_.size() >= kFewestValues && sum().nis() > kBeyondChance;
  is_beyond_chance_ = nis > kBeyondChance || is_sum_beyond_chance;
  if (is_beyond_chance_) last_beyond_chance_ = time;
  if (!alarmed_since_ && (is_sum_beyond_chance || meanNis() > kBeyondChance)) {
    const auto first = std::find_if(values_.begin(), values_.end(),
                                    [](const Value& value) { return value.nis > kBeyondChance; });
    alarmed_since_ = (first == values_.end() ? values_.front() : *first).time;
  } else if (alarmed_since_ && (time - *last_beyond_chance_).seconds() > kCalm_s) {
    alarmed_since_.reset();
  }
}

void InertialMonitor::check(Window& window, const FactorBuilder& factors,
                            const Eigen::Matrix<double, 15, 15>& before) {
  if (const InertialDoubt shaken = vibration_.doubt(); shaken.any())
    window.newest().from_previous->setDoubt(shaken);
  const std::optional<MotionInnovation> innovation =
      motionInnovation(window, factors, before, is_before_placed_);
  is_before_placed_ = innovation.has_value();
  if (!innovation) return;
  const Time time = window.newest().time;
  const double worst = std::max(innovation->rotation_W.nis(), innovation->position_W.nis());
  const bool contradicts = worst > InnovationWatch::kBeyondChance;
  const bool images_suspected = contradicts && areImagesSuspected(*innovation);
  const Quat world_from_body = window.newest().worldFromBody().rotation;
  const Innovation rotation_B = inBody(innovation->rotation_W, world_from_body);
  const Innovation position_B = inBody(innovation->position_W, world_from_body);
  const auto watch = [&](InnovationWatch& sensor, const Innovation& value_B, const char* name) {
    const bool was_alarmed = sensor.isAlarmed();
    sensor.add(time, value_B);
    if (was_alarmed || !sensor.isAlarmed()) return;
    report(*innovation, time, sensor, name);
    if (&sensor != &images_) widenBackwards(sensor, window);
  };
  const Innovation& larger_B = rotation_B.nis() > position_B.nis() ? rotation_B : position_B;
  watch(images_, images_suspected ? larger_B : Innovation{}, "camera");
  watch(gyroscope_, images_suspected ? Innovation{} : rotation_B, "gyroscope");
  watch(accelerometer_, images_suspected ? Innovation{} : position_B, "accelerometer");
  if (images_suspected) {
    // Neither the pose by this image nor its effect on later readings is known.
    is_before_placed_ = false;
    diagnostics_->report(
        Severity::Warning, "image_out_of_place",
        fmt::format("the image at {} ns shows the rig {:.2f} m and {:.1f} degrees from where its motion and "
                    "the inertial readings put it: an image out of order, of another camera or of another "
                    "time? Not followed; `lodeline inspect` looks closer",
                    time.nanoseconds(), innovation->position_W.value.norm(),
                    innovation->rotation_W.value.norm() * kDegreesPerRadian));
    return;
  }
  if (contradicts || isAlarmed()) widen(*innovation, window);
}

bool InertialMonitor::areImagesSuspected(const MotionInnovation& innovation) const {
  const double dt2 = innovation.interval_s * innovation.interval_s;
  const auto jumps = [&](const Vec3& from_steady, const Vec3& from_inertial, double nis, double greatest) {
    const Vec3 inertial_from_steady = from_steady - from_inertial;
    return nis > InnovationWatch::kBeyondChance && from_steady.norm() > dt2 * greatest &&
           inertial_from_steady.norm() < 0.5 * from_steady.norm();
  };
  return jumps(innovation.position_from_steady_W, innovation.position_W.value, innovation.position_W.nis(),
               kGreatestAcceleration_m_per_s2) ||
         jumps(innovation.rotation_from_steady_W, innovation.rotation_W.value, innovation.rotation_W.nis(),
               kGreatestAngularAcceleration_rad_per_s2);
}

void InertialMonitor::widen(const MotionInnovation& innovation, Window& window) {
  Frame& newest = window.newest();
  Frame& before = *window.frames()[window.frames().size() - 2];
  const double dt_s = innovation.interval_s;
  const bool turn_contradicts = gyroscope_.isBeyondChance();
  const bool way_contradicts = accelerometer_.isBeyondChance();
  const Rigid3 before_from_newest = before.worldFromBody().inverse() * innovation.world_from_body;
  NavigationState state = newest.state();
  state.world_from_body = innovation.world_from_body;
  // White noise of density s causes a rotation variance of s^2 dt and a translation variance of s^2 dt^3 / 3.
  InertialDoubt doubt = newest.from_previous->doubt();
  if (turn_contradicts || gyroscope_.isAlarmed()) {
    doubt.gyroscope_density_rad_per_s_sqrtHz = innovation.rotation_W.value.norm() / std::sqrt(dt_s);
    // The readings at both ends belong to the interval.
    before.gyroscope_B = newest.gyroscope_B =
        so3::log(before_from_newest.rotation) / dt_s + state.gyroscope_bias_B;
  }
  if (turn_contradicts && gyroscope_.isAlarmed())
    doubt.gyroscope_bias_step_rad_per_s = initial_.gyroscope_bias_sigma_rad_per_s;
  if (way_contradicts || accelerometer_.isAlarmed()) {
    doubt.accelerometer_density_m_per_s2_sqrtHz =
        innovation.position_W.value.norm() * std::sqrt(3.0 / (dt_s * dt_s * dt_s));
    state.velocity_W = before.worldFromBody().rotation * before_from_newest.translation / dt_s;
  }
  if (way_contradicts && accelerometer_.isAlarmed())
    doubt.accelerometer_bias_step_m_per_s2 = initial_.accelerometer_bias_sigma_m_per_s2;
  newest.from_previous->setDoubt(doubt);
  newest.setState(state);
  // The error of the images may be as large as the smaller of their differences from readings and from
  // inertia.
  if (turn_contradicts || way_contradicts) {
    doubtMotion(shorter(innovation.position_W.value, innovation.position_from_steady_W),
                shorter(innovation.rotation_W.value, innovation.rotation_from_steady_W),
                state.world_from_body.translation);
  }
}

void InertialMonitor::widenBackwards(const InnovationWatch& watch, Window& window) {
  const bool is_gyroscope = &watch == &gyroscope_;
  const auto& frames = window.frames();
  for (size_t i = 1; i + 1 < frames.size(); ++i) {
    Frame& frame = *frames[i];
    if (!frame.from_previous || frame.time < watch.alarmedSince()) continue;
    const double dt_s = frame.from_previous->dt_s();
    InertialDoubt doubt = frame.from_previous->doubt();
    double& density =
        is_gyroscope ? doubt.gyroscope_density_rad_per_s_sqrtHz : doubt.accelerometer_density_m_per_s2_sqrtHz;
    density = std::max(density, watch.meanLength() * (is_gyroscope ? 1.0 / std::sqrt(dt_s)
                                                                   : std::sqrt(3.0 / (dt_s * dt_s * dt_s))));
    frame.from_previous->setDoubt(doubt);
  }
  const Frame& newest = window.newest();
  const Vec3 sum_W = newest.worldFromBody().rotation * watch.sum().value;
  doubtMotion(is_gyroscope ? Vec3::Zero() : sum_W, is_gyroscope ? sum_W : Vec3::Zero(),
              newest.worldFromBody().translation);
}

void InertialMonitor::doubtMotion(const Vec3& position_error_W, const Vec3& rotation_error_W,
                                  const Vec3& position_W) {
  position_doubt_ += position_error_W * position_error_W.transpose();
  rotation_doubt_ += rotation_error_W * rotation_error_W.transpose();
  const double variance = rotation_error_W.squaredNorm() / 3.0;
  turned_ += variance;
  turned_at_W_ += variance * position_W;
  turned_at_squared_ += variance * position_W * position_W.transpose();
}

void InertialMonitor::addTo(const Vec3& position_W, Eigen::Matrix<double, 15, 15>* covariance) const {
  if (turned_ == 0.0 && position_doubt_.isZero(0.0)) return;
  // Sum over the contradictions of variance * arm arm^T; a rotation moves the position perpendicular to the
  // arm.
  const Mat3 arms = turned_at_squared_ + turned_ * position_W * position_W.transpose() -
                    turned_at_W_ * position_W.transpose() - position_W * turned_at_W_.transpose();
  covariance->block<3, 3>(0, 0) += position_doubt_ + arms.trace() * Mat3::Identity() - arms;
  covariance->block<3, 3>(3, 3) += rotation_doubt_;
}

void InertialMonitor::report(const MotionInnovation& innovation, Time time, const InnovationWatch& watch,
                             const char* sensor) {
  const bool is_gyroscope = std::string_view(sensor) == "gyroscope";
  const double sigmas = std::sqrt(is_gyroscope ? innovation.rotation_W.nis() : innovation.position_W.nis());
  diagnostics_->report(
      Severity::Serious, "motion_contradiction",
      fmt::format(
          "images and inertial readings contradict each other from {} ns on; {} suspected. From one image to "
          "the next, at {} ns, they differ by {:.1f} mm and {:.2f} degrees, {:.0f} sigmas. Its unit, range "
          "or "
          "axes, a jump of its bias, images of another time or of another camera do that. The run goes on by "
          "what is more plausible, with wider uncertainty, status 'degraded'; `lodeline inspect` compares "
          "both",
          watch.alarmedSince().nanoseconds(), sensor, time.nanoseconds(),
          1e3 * innovation.position_W.value.norm(), innovation.rotation_W.value.norm() * kDegreesPerRadian,
          sigmas));
}

}  // namespace lodeline
