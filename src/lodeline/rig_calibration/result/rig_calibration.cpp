#include "lodeline/rig_calibration/result/rig_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/geometry/so3.h"
#include "lodeline/rig_calibration/result/camera_results.h"
#include "lodeline/rig_calibration/start/camera_start.h"
#include "lodeline/rig_calibration/start/inertial_start.h"

namespace lodeline {
namespace {

constexpr int kRounds = 5;          // of weights and outlying views
constexpr int kSteps = 25;          // of the solver in a round
constexpr int kInertialRounds = 5;  // of delay and noise
constexpr size_t kLeastImu = 50;

/// Cameras of `record` as the solution starts with them.
BoardRecord prepared(const BoardRecord& record, const RigCalibrationOptions& options) {
  BoardRecord result = record;
  for (CameraCalibration& camera : result.rig.cameras) {
    if (!camera.port && options.port) camera.port = options.port;
  }
  return result;
}

/// Counts the solutions of a calibration.
class SolutionCount {
 public:
  SolutionCount(ShareDone progress, bool has_imu)
      : progress_(std::move(progress)), total_(kRounds + (has_imu ? kInertialRounds + 1 : 0) + 1) {}
  void addOne() { progress_(static_cast<double>(++done_) / total_); }

 private:
  ShareDone progress_;
  int done_ = 0, total_;  ///< the covariance counts as the last one
};

void solveCameras(const CalibrationBoard& board, const FixedParameters& fixed, SolutionCount* count,
                  RigState* state) {
  const InertialLinks none;
  for (int round = 0; round < kRounds; ++round) {
    settleCornerSigmas(board, state);
    RigProblem(state, board, fixed, none).solve(kSteps);
    dropOutlyingFrames(board, state);
    count->addOne();
  }
  settleCornerSigmas(board, state);
}

/// Moves the frames to the times by the new delay of the first camera.
void applyDelay(RigState* state) {
  const double change_s = state->cameras.front().delay_change_s;
  state->delay_s += change_s;
  for (CameraState& camera : state->cameras) camera.delay_change_s -= change_s;
  for (FrameState& frame : state->frames) {
    const Rigid3 pose = poseFromBlock(frame.world_from_body.data());
    const Vec3 rate_B = frame.gyroscope_reading_B - Vec3(frame.motion.data() + 3);
    poseToBlock(Rigid3((pose.rotation * so3::exp(change_s * rate_B)).normalized(),
                       pose.translation + change_s * Vec3(frame.motion.data())),
                frame.world_from_body.data());
  }
}

/// Solves with the inertial readings. The last problem stays for the covariance.
struct InertialSolution {
  InertialLinks links;
  double noise_inflation = 1.0;
};

InertialSolution solveInertial(const BoardRecord& record, const FixedParameters& fixed, SolutionCount* count,
                               RigState* state) {
  InertialSolution solution;
  for (int round = 0; round < kInertialRounds; ++round) {
    solution.links = linkFrames(record.imu, record.rig.imu, solution.noise_inflation, state);
    RigProblem problem(state, record.board, fixed, solution.links);
    problem.solve(kSteps);
    const double error = std::sqrt(problem.inertialVariance());
    solution.noise_inflation = std::max(1.0, solution.noise_inflation * error);
    applyDelay(state);
    settleCornerSigmas(record.board, state);
    count->addOne();
  }
  solution.links = linkFrames(record.imu, record.rig.imu, solution.noise_inflation, state);
  RigProblem(state, record.board, fixed, solution.links).solve(kSteps);
  count->addOne();
  return solution;
}

InertialResult inertialResult(const InertialStart& start, double noise_inflation, const BoardRecord& record,
                              const RigState& state) {
  InertialResult result;
  result.inertial_error = noise_inflation;
  result.rate_error_rad_per_s = start.rate_error_rad_per_s;
  result.least_rate_rad_per_s = start.least_rate_rad_per_s;
  result.least_acceleration_m_per_s2 = leastAcceleration(state, record.imu);
  for (const FrameState& frame : state.frames) {
    result.gyroscope_bias_B += Vec3(frame.motion.data() + 3) / static_cast<double>(state.frames.size());
    result.accelerometer_bias_B += Vec3(frame.motion.data() + 6) / static_cast<double>(state.frames.size());
  }
  return result;
}

std::string whyWithoutImu(const BoardRecord& record, const RigCalibrationOptions& options) {
  if (!options.uses_imu) return "not asked for";
  if (record.imu.size() < kLeastImu) return "the recording has no inertial readings";
  return "";
}

}  // namespace

RigCalibrationResult calibrateRig(const BoardRecord& given, const RigCalibrationOptions& options,
                                  Diagnostics* diagnostics) {
  const BoardRecord record = prepared(given, options);
  const FixedParameters fixed{options.keeps_lens, options.keeps_port};
  RigState state = startCameras(record, {options.model, options.keeps_lens}, diagnostics);
  RigCalibrationResult result;
  result.without_inertial = whyWithoutImu(record, options);
  SolutionCount count(options.progress, result.without_inertial.empty());
  solveCameras(record.board, fixed, &count, &state);
  result.board = record.board;
  result.rig = record.rig;
  InertialSolution solution;
  if (result.without_inertial.empty()) {
    const InertialStart start = alignRates(state, record.imu, options.most_delay_s);
    enterInertialFrame(start, record.imu, &state);
    solution = solveInertial(record, fixed, &count, &state);
    result.inertial = inertialResult(start, solution.noise_inflation, record, state);
  }
  RigProblem problem(&state, record.board, fixed, solution.links);
  const Posterior posterior = problem.posterior();
  count.addOne();
  result.sigma_inflation = posterior.largest_inflation;
  result.cameras = cameraResults(record, state, posterior, result.inertial.has_value());
  for (size_t k = 0; k < result.cameras.size(); ++k) result.rig.cameras[k] = result.cameras[k].calibration;
  judge(&result);
  return result;
}

}  // namespace lodeline
