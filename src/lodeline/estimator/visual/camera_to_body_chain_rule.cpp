#include "lodeline/estimator/visual/camera_to_body_chain_rule.h"

#include <algorithm>

#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/factors/rolling_shutter.h"
#include "lodeline/problem/simd_gemm.h"

namespace lodeline {

CameraToBodyChainRule::CameraToBodyChainRule(const Window& window, const CameraStates& states,
                                             const CameraViews& first, int rows)
    : window_(window),
      states_(states),
      first_(first),
      frames_(static_cast<int>(window.frames().size())),
      rows_(rows) {
  for (const auto& frame : window.frames()) {
    if (frame->interpolated) continue;
    append(frame->pose.data(), kPoseSize);
    poses_ += kPoseTangentSize;
  }
  if (!states_) return;
  for (ParameterBlock* state : states_.secondary) append(state->value.data(), kExtrinsicsSize);
  for (ParameterBlock* state : states_.intrinsics) append(state->value.data(), kIntrinsicsSize);
  if (states_.shutter) append(states_.shutter->value.data(), kShutterSize);
  others_ = rows_ - 6 * frames_;
  append(states_.camera0->value.data(), kExtrinsicsSize);
  append(states_.time_offset->value.data(), kTimeOffsetSize);
  calibration_ = kExtrinsicsSize + kTimeOffsetSize;
}

void CameraToBodyChainRule::append(double* value, int size) {
  const int offset = blocks_.empty() ? 0 : blocks_.back().offset + blocks_.back().tangentSize();
  blocks_.push_back({value, size, offset});
}

int CameraToBodyChainRule::columnOf(const Frame& frame) const {
  const auto is_its = [&](const auto& block) { return block.value == frame.pose.data(); };
  return std::find_if(blocks_.begin(), blocks_.end(), is_its)->offset;
}

CameraToBodyChainRule::Follows CameraToBodyChainRule::posesOf(int frame) const {
  const Frame& target = *window_.frames()[static_cast<size_t>(frame)];
  const Mat6& by_body = first_.placement(frame).by_body;
  if (!target.interpolated) return {{Part{columnOf(target), by_body}}, 1};
  const auto& [before_id, after_id, between] = *target.interpolated;
  const Frame &before = *window_.find(before_id), &after = *window_.find(after_id);
  const auto [by_before, by_after] =
      between.derivatives(before.firstWorldFromBody(), after.firstWorldFromBody());
  return {{Part{columnOf(before), by_body * by_before}, Part{columnOf(after), by_body * by_after}}, 2};
}

void CameraToBodyChainRule::update() {
  follows_.clear();
  for (int i = 0; i < frames_; ++i) follows_.push_back(posesOf(i));
}

void CameraToBodyChainRule::transform(const Eigen::MatrixXd& h_nodes, const Eigen::VectorXd& g_nodes,
                                      Eigen::MatrixXd* h, Eigen::VectorXd* g) const {
  const int columns = poses_ + others_ + calibration_, of_frames = 6 * frames_;
  const Eigen::MatrixXd of_nodes = h_nodes.selfadjointView<Eigen::Lower>();
  h->setZero(columns, columns);
  g->setZero(columns);
  addPoses(of_nodes, h);
  for (int i = 0; i < frames_; ++i) {
    for (const Part& part : follows_[static_cast<size_t>(i)]) {
      h->block(poses_, part.column, others_, 6).noalias() +=
          of_nodes.block(of_frames, 6 * i, others_, 6) * part.by_pose;
      g->segment<6>(part.column).noalias() += part.by_pose.transpose() * g_nodes.segment<6>(6 * i);
    }
  }
  h->block(poses_, poses_, others_, others_) = of_nodes.bottomRightCorner(others_, others_);
  g->segment(poses_, others_) = g_nodes.segment(of_frames, others_);
  if (calibration_ > 0) addCalibration(of_nodes, g_nodes, h, g);
}

void CameraToBodyChainRule::addPoses(const Eigen::MatrixXd& of_nodes, Eigen::MatrixXd* h) const {
  // -h_nodes T. The lower triangle of T^T h_nodes T needs only its rows of later frames.
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(6 * frames_, poses_);
  for (int i = 0; i < frames_; ++i) {
    for (const Part& part : follows_[static_cast<size_t>(i)]) {
      const int first = 6 * firstTouching(part.column), rows = 6 * frames_ - first;
      subtractProduct(of_nodes.block(first, 6 * i, rows, 6), part.by_pose.transpose(),
                      half.block(first, part.column, rows, 6));
    }
  }
  for (int i = 0; i < frames_; ++i) {
    for (const Part& part : follows_[static_cast<size_t>(i)]) {
      h->block(part.column, 0, 6, part.column + 6).noalias() -=
          part.by_pose.transpose() * half.block(6 * i, 0, 6, part.column + 6);
    }
  }
}

int CameraToBodyChainRule::firstTouching(int column) const {
  const auto touches = [column](const Follows& follows) {
    return std::any_of(follows.begin(), follows.end(),
                       [column](const Part& part) { return part.column >= column; });
  };
  return static_cast<int>(std::find_if(follows_.begin(), follows_.end(), touches) - follows_.begin());
}

void CameraToBodyChainRule::addCalibration(const Eigen::MatrixXd& of_nodes, const Eigen::VectorXd& g_nodes,
                                           Eigen::MatrixXd* h, Eigen::VectorXd* g) const {
  Eigen::MatrixXd by_calibration = Eigen::MatrixXd::Zero(rows_, calibration_);
  for (int i = 0; i < frames_; ++i) by_calibration.middleRows<6>(6 * i) = first_.placement(i).by_calibration;
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(rows_, calibration_);
  subtractProduct(of_nodes, by_calibration.transpose(), half);
  half = -half;
  auto rows = h->bottomRows(calibration_);
  for (int i = 0; i < frames_; ++i) {
    for (const Part& part : follows_[static_cast<size_t>(i)])
      rows.middleCols<6>(part.column).noalias() += half.middleRows<6>(6 * i).transpose() * part.by_pose;
  }
  rows.middleCols(poses_, others_) = half.bottomRows(others_).transpose();
  rows.rightCols(calibration_).noalias() = by_calibration.transpose() * half;
  g->tail(calibration_).noalias() = by_calibration.transpose() * g_nodes;
}

Eigen::VectorXd CameraToBodyChainRule::stepOfNodes(const NormalEquations& system,
                                                   const Eigen::VectorXd& step) const {
  Eigen::VectorXd of_blocks(poses_ + others_ + calibration_);
  for (const NormalEquations::Block& block : blocks_) {
    const int size = block.tangentSize();
    of_blocks.segment(block.offset, size) = step.segment(system.find(block.value)->offset, size);
  }
  Eigen::VectorXd steps = Eigen::VectorXd::Zero(rows_);
  for (int i = 0; i < frames_; ++i) {
    auto of_frame = steps.segment<6>(6 * i);
    if (calibration_ > 0)
      of_frame = first_.placement(i).by_calibration * of_blocks.tail<kExtrinsicsSize + kTimeOffsetSize>();
    for (const Part& part : follows_[static_cast<size_t>(i)])
      of_frame += part.by_pose * of_blocks.segment<6>(part.column);
  }
  steps.segment(6 * frames_, others_) = of_blocks.segment(poses_, others_);
  return steps;
}

}  // namespace lodeline
