#include "lodeline/estimator/trials/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/geometry/so3.h"
#include "simulation/motion/hand_motion.h"

namespace lodeline {
namespace {

constexpr double kRoomRadius_m = 5.0;
constexpr double kRoomHalfHeight_m = 2.5;

Motion swaying(const TestSceneOptions& options) {
  Random random(options.seed, "scene/phases");
  const auto covered = [](const std::vector<MotionInterval>& spans, double t) {
    return std::any_of(spans.begin(), spans.end(),
                       [t](const MotionInterval& span) { return span.contains(t); });
  };
  const auto addSway = [&](MotionChannel& channel, double amplitude, double rate_rad_per_s, bool is_turn,
                           double from_s = -1e9) {
    const auto activity = [&](double t) {
      if (t < from_s) return 0.0;
      const bool rests = covered(options.still, t) || (!is_turn && covered(options.on_the_spot, t));
      return rests ? 0.0 : options.liveliness;
    };
    // One knot per second brings the rig to rest smoothly within 3 s.
    channel.sines.push_back(
        {motionSpline(options.duration_s, 1.0, [&](double t) { return amplitude * activity(t); }),
         motionSpline(options.duration_s, 1.0, [&](double t) { return rate_rad_per_s * t; }), 1.0,
         random.uniform(0.0, 2.0 * std::numbers::pi)});
  };
  const auto add = [&](MotionChannel& channel, double amplitude_m, double rate_rad_per_s) {
    addSway(channel, amplitude_m * options.translation, rate_rad_per_s, false);
  };
  const auto addTurn = [&](MotionChannel& channel, double amplitude_rad, double rate_rad_per_s) {
    addSway(channel, amplitude_rad, rate_rad_per_s, true);
  };
  MotionChannels channels;
  add(channels.east, 1.0, 0.7);
  add(channels.east, 0.2, 2.1);
  add(channels.north, 0.8, 0.9);
  add(channels.up, 0.3, 1.3);
  addTurn(channels.yaw, 0.5, 0.4);
  addTurn(channels.pitch, 0.2, 1.1);
  addTurn(channels.roll, 0.15, 0.8);
  if (options.hurry_rad_per_s > 0.0) addSway(channels.yaw, options.hurry_rad_per_s / 0.5, 0.5, true, 5.0);
  MotionChannel* path[] = {&channels.east, &channels.north, &channels.up};
  for (int axis = 0; axis < 3; ++axis) {
    path[axis]->splines.push_back(
        motionSpline(options.duration_s, 1.0, [&](double t) { return options.drift_m_per_s[axis] * t; }));
  }
  return Motion(std::move(channels), Rigid3(), options.duration_s);
}

LandmarkField room(const TestSceneOptions& options, const Vec3& centre) {
  Random random(options.seed, "scene/room");
  std::vector<LandmarkPoint> points;
  for (int i = 0; i < 2000; ++i) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vec3 inward(-std::cos(angle), -std::sin(angle), 0.0);
    const double radius = kRoomRadius_m + options.wall_roughness_m * random.uniform(-1.0, 1.0);
    const double height = random.uniform(-kRoomHalfHeight_m, kRoomHalfHeight_m);
    points.push_back({centre - radius * inward + height * Vec3::UnitZ(), inward});
  }
  return LandmarkField(std::move(points));
}

PointSimulationOptions pointOptions(const TestSceneOptions& options, const Rig& rig) {
  PointSimulationOptions points = options.points;
  points.seed = options.seed;
  points.end_s = options.duration_s;
  Random random(options.seed, "scene/biases");
  points.imu.gyroscope.turn_on_bias = options.gyroscope_bias_sigma_rad_per_s * random.normal3();
  points.imu.accelerometer.turn_on_bias = options.accelerometer_bias_sigma_m_per_s2 * random.normal3();
  const ImuNoise& noise = rig.imu.noise;
  points.imu.gyroscope.noise_density = noise.gyroscope_density_rad_per_s_sqrtHz;
  points.imu.gyroscope.random_walk = noise.gyroscope_random_walk_rad_per_s2_sqrtHz;
  points.imu.accelerometer.noise_density = noise.accelerometer_density_m_per_s2_sqrtHz;
  points.imu.accelerometer.random_walk = noise.accelerometer_random_walk_m_per_s3_sqrtHz;
  return points;
}

}  // namespace

Rig testRig(int cameras) {
  Mat3 body_from_camera;
  body_from_camera << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  CameraCalibration camera;
  camera.width_px = 752;
  camera.height_px = 480;
  camera.fx_px = camera.fy_px = 458.0;
  camera.cx_px = 375.5;
  camera.cy_px = 239.5;
  Rig rig;
  for (int i = 0; i < cameras; ++i) {
    camera.name = "cam" + std::to_string(i);
    camera.body_from_camera = Rigid3(Quat(body_from_camera), Vec3(0.02, 0.05 - 0.11 * i, 0.0));
    rig.cameras.push_back(camera);
  }
  rig.pressure = PressureCalibration{2.0, 0.02, Rigid3(Quat::Identity(), Vec3(-0.12, 0.0, 0.03))};
  return rig;
}

TestScene::TestScene(const TestSceneOptions& options)
    : start_(options.points.start),
      rig_(testRig(options.cameras)),
      motion_(swaying(options)),
      landmarks_(room(options, motion_.worldShift())),
      simulation_(motion_, landmarks_, rig_, pointOptions(options, rig_)) {}

double TestScene::distanceToWall_m(const Vec3& origin_W, const Vec3& direction_W) const {
  const Vec2 from = (origin_W - motion_.worldShift()).head<2>(), along = direction_W.head<2>();
  const double a = along.squaredNorm(), b = from.dot(along);
  const double c = from.squaredNorm() - kRoomRadius_m * kRoomRadius_m;
  return (std::sqrt(b * b - a * c) - b) / a;
}

std::vector<SimulatedFrame> TestScene::all() {
  std::vector<SimulatedFrame> frames;
  while (auto frame = next()) frames.push_back(std::move(*frame));
  return frames;
}

EstimatorOptions honestOptions(const TestSceneOptions& scene) {
  EstimatorOptions options;
  options.preintegration.noise_inflation = 1.0;
  options.preintegration.motion_noise = MotionNoiseOptions::none();
  options.imu_axes.gyroscope_sigma = options.imu_axes.accelerometer_sigma = 0.0;
  options.initial_state.gyroscope_bias_sigma_rad_per_s = scene.gyroscope_bias_sigma_rad_per_s;
  options.initial_state.accelerometer_bias_sigma_m_per_s2 = scene.accelerometer_bias_sigma_m_per_s2;
  return options;
}

Rigid3 estimateFromTruth(const Rigid3& linearization_point, const Rigid3& first_truth) {
  Quat heading = Quat::Identity();
  for (int pass = 0; pass < 20; ++pass) {
    const Vec3 left = so3::log(heading * first_truth.rotation * linearization_point.rotation.conjugate());
    heading = so3::exp(Vec3(0.0, 0.0, -left.z())) * heading;
  }
  return Rigid3(heading, linearization_point.translation - heading * first_truth.translation);
}

namespace {

/// Turns an estimate about the vertical through the world's origin.
void turn(double angle_rad, FrameEstimate* estimate) {
  const Quat turned_from_world = so3::exp(angle_rad * Vec3::UnitZ());
  NavigationState& state = estimate->state;
  state.world_from_body = Rigid3(turned_from_world, Vec3::Zero()) * state.world_from_body;
  state.velocity_W = turned_from_world * state.velocity_W;
  const Mat3 rotation = turned_from_world.toRotationMatrix();
  Eigen::Matrix<double, 15, 15> by = Eigen::Matrix<double, 15, 15>::Identity();
  for (const int block : {0, 3, 6}) by.block<3, 3>(block, block) = rotation;
  estimate->covariance = by * estimate->covariance * by.transpose();
}

}  // namespace

Comparison TruthComparison::compare(const SimulatedFrame& frame, const FrameEstimate& estimate,
                                    const Estimator& estimator) {
  const Rigid3& truth = frame.truth.motion.world_from_body;
  Comparison result;
  static const PointSimulationOptions usual;  // as TestScene uses it
  result.time_s = (frame.truth.time - usual.start).seconds();
  result.estimate = estimate;
  if (!estimate_from_truth_) true_poses_[frame.truth.time] = truth;
  if (!result.initialized()) return result;
  if (!estimate_from_truth_) {
    // The oldest frame has the most accurate prior, at its linearization point.
    const Frame& oldest = *estimator.window().frames().front();
    const Rigid3 linearization_point =
        oldest.firstPose() ? poseFromBlock(oldest.firstPose()) : oldest.worldFromBody();
    const Rigid3& first_truth = true_poses_.at(oldest.time);
    estimate_from_truth_ = estimateFromTruth(linearization_point, first_truth);
    is_relative_to_north_ =
        estimate.sensors.of<MagnetometerEstimate>().heading_reference != HeadingReference::Start;
    if (is_relative_to_north_) {
      // The field points along the world's y axis in the simulation.
      *estimate_from_truth_ =
          Rigid3(Quat::Identity(), linearization_point.translation - first_truth.translation);
    }
    true_poses_.clear();
  }
  result.true_world_from_body = *estimate_from_truth_ * truth;
  result.true_velocity_W = estimate_from_truth_->rotation * frame.truth.motion.velocity_W;
  result.true_gyroscope_bias_B = frame.truth.gyroscope_bias_B;
  result.true_accelerometer_bias_B = frame.truth.accelerometer_bias_B;
  if (is_relative_to_north_)
    turn(*estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad, &result.estimate);
  result.error = perturbationBetween(result.true_world_from_body, result.estimate.state.world_from_body);
  return result;
}

Comparison ComparedEstimator::add(const SimulatedFrame& frame, std::span<const DepthSample> depth) {
  return add(frame, SensorReadings(std::vector<DepthSample>(depth.begin(), depth.end())));
}

Comparison ComparedEstimator::add(const SimulatedFrame& frame, const SensorReadings& readings) {
  const FrameEstimate estimate = estimator_.add(frame.tracks, frame.imu, readings);
  Comparison comparison = comparison_.compare(frame, estimate, estimator_);
  comparison.time_s = scene_.secondsOf(frame.truth.time);
  return comparison;
}

std::vector<Comparison> compare(TestScene& scene, const EstimatorOptions& options) {
  ComparedEstimator estimator(scene, options);
  std::vector<Comparison> comparisons;
  while (const auto frame = scene.next()) comparisons.push_back(estimator.add(*frame));
  return comparisons;
}

}  // namespace lodeline
