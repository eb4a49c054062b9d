#include "lodeline/batch/loops/test_circuit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lodeline/batch/loops/initial_correction.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/simulation.h"
#include "simulation/motion/hand_motion.h"

namespace lodeline {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRest_s = 5.0, kPickUp_s = 4.0;

/// Length of the way at a time: at rest, then at a constant speed.
double wayAt(double t, double speed_m_per_s) {
  const double u = std::clamp((t - kRest_s) / kPickUp_s, 0.0, 1.0);
  const double while_waking = kPickUp_s * (u * u * u - 0.5 * u * u * u * u);
  return speed_m_per_s * (while_waking + std::max(0.0, t - kRest_s - kPickUp_s));
}

Motion circling(const BatchCircuitOptions& options, double duration_s, const Rigid3& diver_from_body) {
  const auto angle = [&](double t) { return wayAt(t, options.speed_m_per_s) / options.radius_m; };
  const auto spline = [&](const auto& of) {
    MotionChannel channel;
    channel.splines.push_back(motionSpline(duration_s, 0.5, [&](double t) { return of(angle(t)); }));
    return channel;
  };
  MotionChannels c;
  c.east = spline([&](double a) { return options.radius_m * std::sin(a); });
  c.north = spline([&](double a) { return options.radius_m * (1.0 - std::cos(a)); });
  c.up = spline([](double a) { return 1.5 * (std::cos(a) - 1.0); });
  c.yaw = spline([](double a) { return a; });
  c.pitch = c.roll = spline([](double) { return 0.0; });
  HandMotionOptions hand;
  hand.seed = options.seed;
  hand.duration_s = duration_s;
  hand.sweeps = false;
  hand.activity = [](double t) { return std::clamp((t - kRest_s) / kPickUp_s, 0.0, 1.0); };
  hand.kick = hand.activity;
  addHandMotion(hand, c);
  return Motion(std::move(c), diver_from_body, duration_s);
}

/// Points on the walls of an elliptic passage around the circle.
LandmarkField ringLandmarks(const BatchCircuitOptions& options, const Vec3& shift_W) {
  Random random(options.seed, "circuit/points");
  std::vector<LandmarkPoint> points;
  const int count = static_cast<int>(kTurn * options.radius_m * options.points_per_metre);
  for (int i = 0; i < count; ++i) {
    const double a = random.uniform(0.0, kTurn), section = random.uniform(0.0, kTurn);
    const double rough = 1.0 + 0.1 * random.normal();
    const Vec3 outward(std::sin(a), -std::cos(a), 0.0);
    const Vec3 centre(options.radius_m * std::sin(a), options.radius_m * (1.0 - std::cos(a)),
                      1.5 * (std::cos(a) - 1.0));
    const Vec3 offset = rough * (2.0 * std::cos(section) * outward + 1.3 * std::sin(section) * Vec3::UnitZ());
    points.push_back({centre + offset + shift_W, -offset.normalized()});
  }
  return LandmarkField(std::move(points));
}

Rig givenRig(Rig rig, const BatchCircuitOptions& options) {
  for (CameraCalibration& camera : rig.cameras) {
    camera.fx_px *= 1.0 + options.focal_length_error;
    camera.fy_px *= 1.0 + options.focal_length_error;
  }
  const Rigid3& first = rig.cameras.front().body_from_camera;
  Rigid3& second = rig.cameras.back().body_from_camera;
  const Vec3 baseline = second.translation - first.translation;
  second.translation += options.baseline_error * baseline;
  second.rotation = second.rotation * so3::exp(options.rotation_error_rad * Vec3(0.6, -0.5, 0.6));
  return rig;
}

}  // namespace

CircuitRun::CircuitRun(const BatchCircuitOptions& wanted) {
  MountedRig mounted = standardRig({});
  const ImuErrors imu = drawImuErrors(imuGrade("gx5-25"), {}, wanted.seed);
  mounted.rig.imu.noise = statedNoise(imu);
  rig = givenRig(mounted.rig, wanted);
  lap_s = kTurn * wanted.radius_m / wanted.speed_m_per_s;
  const double duration_s = kRest_s + 0.5 * kPickUp_s + wanted.laps * lap_s;
  const Motion motion = circling(wanted, duration_s, mounted.diver_from_body);
  const LandmarkField landmarks = ringLandmarks(wanted, motion.worldShift());
  PointSimulationOptions points;
  points.seed = wanted.seed;
  points.frame_rate_hz = wanted.frame_rate_hz;
  points.tracks = wanted.tracks;
  points.imu = imu;
  PointSimulation simulation(motion, landmarks, mounted.rig, rig, points);
  Diagnostics diagnostics;
  Estimator estimator(rig, options, &diagnostics);
  TruthComparison comparison;
  while (const auto frame = simulation.next()) {
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
    record.add(frame->tracks, frame->imu, estimate, estimator);
    const Comparison compared = comparison.compare(*frame, estimate, estimator);
    if (!compared.initialized()) continue;
    truth.push_back(compared.true_world_from_body);
    std::vector<Seen>& of_frame = seen.emplace_back();
    for (const FeatureObservation& observation : frame->tracks.observations)
      of_frame.push_back({observation, simulation.landmark(observation.track)});
  }
  record.finish(estimator);
}

double CircuitRun::rootMeanSquare(const std::vector<FrameEstimate>& frames) const {
  double sum = 0.0;
  for (size_t i = 0; i < frames.size(); ++i)
    sum += (frames[i].state.world_from_body.translation - truth[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(frames.size()));
}

LoopClosures circuitLoops(const CircuitRun& run, const CircuitLoopOptions& options) {
  const std::vector<FrameEstimate>& frames = run.record.frames();
  Random random(1, "circuit/loops");
  LoopClosures loops;
  loops.initial_poses.push_back({frames.front().time, frames.front().state.world_from_body});
  const auto secondsOf = [&](size_t i) { return (frames[i].time - frames.front().time).seconds(); };
  const auto isState = [&](size_t i) {
    const auto& states = run.record.states();
    return std::any_of(states.begin(), states.end(),
                       [&](const RecordedState& state) { return state.state.time == frames[i].time; });
  };
  std::optional<InitialCorrection> of_first_lap;
  double last_s = run.lap_s - 0.5;
  for (size_t now = 0; now < frames.size(); ++now) {
    if (secondsOf(now) < last_s + options.interval_s || !isState(now)) continue;
    last_s = secondsOf(now);
    size_t old = 0;
    for (size_t i = 1; i < frames.size() && secondsOf(i) < run.lap_s - 10.0; ++i) {
      if ((run.truth[i].translation - run.truth[now].translation).norm() <
          (run.truth[old].translation - run.truth[now].translation).norm())
        old = i;
    }
    // As a pose graph places it: by the images' relative pose.
    const NavigationState before = of_first_lap ? of_first_lap->apply(frames[old].state) : frames[old].state;
    loops.initial_poses.push_back(
        {frames[now].time, before.world_from_body * (run.truth[old].inverse() * run.truth[now])});
    if (!of_first_lap) of_first_lap.emplace(frames, loops.initial_poses);
    const std::vector<CircuitRun::Seen>& earlier = run.seen[old];
    for (const CircuitRun::Seen& seen : run.seen[now]) {
      if (seen.observation.camera > 0 && options.are_tracked) continue;
      auto match = std::find_if(earlier.begin(), earlier.end(),
                                [&](const CircuitRun::Seen& other) { return other.point_W == seen.point_W; });
      if (match == earlier.end()) continue;
      if (random.chance(options.wrong_share))
        match = earlier.begin() + random.index(static_cast<int>(earlier.size()));
      loops.observations.push_back(
          {match->observation.track, frames[old].time, frames[now].time, seen.observation});
      if (!options.are_tracked) loops.observations.back().observation.track = -1;
    }
  }
  return loops;
}

}  // namespace lodeline
