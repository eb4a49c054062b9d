#include "lodeline/rig_calibration/problem/rig_problem.h"

#include <ceres/loss_function.h>
#include <ceres/solver.h>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/inertial_factor.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/rig_calibration/problem/corner_factor.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kLossWidth_sigmas = 3.0;
constexpr double kGyroscopeBiasSigma_rad_per_s = 0.1;
constexpr double kAccelerometerBiasSigma_m_per_s2 = 0.5;
constexpr double kVelocitySigma_m_per_s = 10.0;
// What is known of any housing before its calibration.
constexpr double kPortTiltSigma_rad = 5.0 * kDegree;
constexpr double kPortLengthSigma_m = 0.02;
// Fresh water to salt water. Beside an unknown focal length, the index cannot be observed: the stated one
// counts.
constexpr double kWaterIndexSigma = 0.01;
constexpr double kStatedIndexSigma = 1e-7;

}  // namespace

RigProblem::RigProblem(RigState* state, const CalibrationBoard& board, const FixedParameters& fixed,
                       const InertialLinks& links)
    : state_(state), by_frame_(state->frames.size()) {
  ceres::Problem::Options options;
  options.evaluation_callback = this;
  problem_ = std::make_unique<ceres::Problem>(options);
  addCorners(board);
  if (!links.empty()) addLinks(links);
  addPortPriors(fixed.lens);
  settleConstants(fixed, !links.empty());
}

RigProblem::~RigProblem() = default;

void RigProblem::addCorners(const CalibrationBoard& board) {
  for (size_t f = 0; f < state_->frames.size(); ++f) {
    FrameState& frame = state_->frames[f];
    for (const BoardView& view : frame.seen->views) {
      CameraState& camera = state_->cameras[view.camera];
      std::vector<double*> blocks = {
          frame.world_from_body.data(), frame.motion.data(), camera.body_from_camera.data(),
          &camera.delay_change_s,       state_->tilt.data(), camera.lens.data()};
      if (camera.base.port) blocks.push_back(camera.port.data());
      for (const BoardCorner& corner : view.corners) {
        auto* factor = new CornerFactor(state_, &camera, &frame, board.corner_T(corner.index), corner.pixel);
        by_frame_[f].push_back(
            problem_->AddResidualBlock(factor, new ceres::CauchyLoss(kLossWidth_sigmas), blocks));
      }
    }
  }
}

void RigProblem::addLinks(const InertialLinks& links) {
  Eigen::VectorXd sigmas(kMotionSize);
  sigmas << Vec3::Constant(kVelocitySigma_m_per_s), Vec3::Constant(kGyroscopeBiasSigma_rad_per_s),
      Vec3::Constant(kAccelerometerBiasSigma_m_per_s2);
  const Vec3 gravity_W(0.0, 0.0, -kStandardGravity);
  for (size_t f = 0; f < state_->frames.size(); ++f) {
    FrameState& frame = state_->frames[f];
    if (f == 0 || !links[f - 1]) {
      // The first frame of a stretch.
      std::array<double, kMotionSize> now = frame.motion;
      std::fill(frame.motion.begin() + 3, frame.motion.end(), 0.0);
      priors_.emplace_back().append(frame.motion.data(), kMotionSize, sigmas);
      frame.motion = now;
      by_frame_[f].push_back(
          problem_->AddResidualBlock(new PriorFactor(priors_.back()), nullptr, frame.motion.data()));
    }
    if (f >= links.size() || !links[f]) continue;
    FrameState& next = state_->frames[f + 1];
    inertial_.push_back(problem_->AddResidualBlock(new InertialFactor(links[f].get(), gravity_W), nullptr,
                                                   frame.world_from_body.data(), frame.motion.data(),
                                                   next.world_from_body.data(), next.motion.data()));
    by_frame_[f].push_back(inertial_.back());
  }
}

void RigProblem::addPortPriors(bool keeps_lens) {
  for (CameraState& camera : state_->cameras) {
    if (!camera.base.port || !problem_->HasParameterBlock(camera.port.data())) continue;
    Eigen::VectorXd sigmas(kPortSize);
    sigmas.setConstant(kPortLengthSigma_m);
    if (camera.base.port->type == Port::Type::Flat) sigmas.head<2>().setConstant(kPortTiltSigma_rad);
    sigmas[3] = keeps_lens ? kWaterIndexSigma : kStatedIndexSigma;
    const std::array<double, kPortSize> now = camera.port;
    camera.port.fill(0.0);
    priors_.emplace_back().append(camera.port.data(), kPortSize, sigmas);
    camera.port = now;
    without_frame_.push_back(
        problem_->AddResidualBlock(new PriorFactor(priors_.back()), nullptr, camera.port.data()));
  }
}

void RigProblem::settleConstants(const FixedParameters& fixed, bool has_links) {
  const auto hold = [&](double* block) {
    if (problem_->HasParameterBlock(block)) problem_->SetParameterBlockConstant(block);
  };
  for (FrameState& frame : state_->frames) {
    problem_->SetManifold(frame.world_from_body.data(), new PoseManifold);
    if (!has_links) hold(frame.motion.data());
  }
  for (size_t k = 0; k < state_->cameras.size(); ++k) {
    CameraState& camera = state_->cameras[k];
    if (!problem_->HasParameterBlock(camera.lens.data())) continue;
    problem_->SetManifold(camera.body_from_camera.data(), new PoseManifold);
    if (!has_links) hold(&camera.delay_change_s);
    if (!has_links && k == 0) hold(camera.body_from_camera.data());
    if (fixed.lens) hold(camera.lens.data());
    if (fixed.port) hold(camera.port.data());
  }
  if (!has_links) hold(state_->tilt.data());
}

void RigProblem::PrepareForEvaluation(bool, bool new_evaluation_point) {
  if (!new_evaluation_point) return;
  for (CameraState& camera : state_->cameras) camera.refresh();
}

void RigProblem::solve(int most_steps) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = most_steps;
  options.function_tolerance = 1e-9;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  for (CameraState& camera : state_->cameras) camera.refresh();
  if (!summary.IsSolutionUsable())
    throw EstimationError("the calibration could not be solved: " + summary.message);
}

double RigProblem::inertialVariance() {
  if (inertial_.empty()) return 0.0;
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = inertial_;
  double cost = 0.0;
  problem_->Evaluate(options, &cost, nullptr, nullptr, nullptr);
  // Of the 15 residuals of a link, velocity and biases of the next frame take 9.
  return 2.0 * cost / (6.0 * static_cast<double>(inertial_.size()));
}

}  // namespace lodeline
