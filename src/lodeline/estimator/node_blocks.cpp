#include "lodeline/estimator/node_blocks.h"

#include <algorithm>

#include "lodeline/estimator/wide_products.h"
#include "lodeline/factors/intrinsics_factor.h"

namespace lodeline {

NodeBlocks::NodeBlocks(const Window& window, const CameraStates& states, const CameraViews& first, int nodes)
    : window_(window),
      states_(states),
      first_(first),
      frames_(static_cast<int>(window.frames().size())),
      nodes_(nodes) {
  for (const auto& frame : window.frames()) {
    if (frame->interpolated) continue;
    append(frame->pose.data(), kPoseSize);
    poses_ += kPoseTangentSize;
  }
  if (!states_) return;
  for (GlobalState* state : states_.further) append(state->value.data(), kExtrinsicsSize);
  for (GlobalState* state : states_.intrinsics) append(state->value.data(), kIntrinsicsSize);
  others_ = 6 * (nodes_ - frames_);
  append(states_.camera0->value.data(), kExtrinsicsSize);
  append(states_.time_offset->value.data(), kTimeOffsetSize);
  calibration_ = kExtrinsicsSize + kTimeOffsetSize;
}

void NodeBlocks::append(double* value, int size) {
  const int offset = blocks_.empty() ? 0 : blocks_.back().offset + blocks_.back().tangentSize();
  blocks_.push_back({value, size, offset});
}

int NodeBlocks::columnOf(const Frame& frame) const {
  const auto is_its = [&](const auto& block) { return block.value == frame.pose.data(); };
  return std::find_if(blocks_.begin(), blocks_.end(), is_its)->offset;
}

NodeBlocks::Follows NodeBlocks::posesOf(int frame) const {
  const Frame& target = *window_.frames()[static_cast<size_t>(frame)];
  const Mat6& by_body = first_.placement(frame).by_body;
  if (!target.interpolated) return {{Part{columnOf(target), by_body}}, 1};
  const auto& [before_id, after_id, between] = *target.interpolated;
  const Frame &before = *window_.find(before_id), &after = *window_.find(after_id);
  const auto [by_before, by_after] =
      between.derivatives(before.firstWorldFromBody(), after.firstWorldFromBody());
  return {{Part{columnOf(before), by_body * by_before}, Part{columnOf(after), by_body * by_after}}, 2};
}

void NodeBlocks::update() {
  follows_.clear();
  for (int i = 0; i < frames_; ++i) follows_.push_back(posesOf(i));
}

void NodeBlocks::transform(const Eigen::MatrixXd& h_nodes, const Eigen::VectorXd& g_nodes, Eigen::MatrixXd* h,
                           Eigen::VectorXd* g) const {
  const int columns = poses_ + others_ + calibration_;
  const Eigen::MatrixXd of_nodes = h_nodes.selfadjointView<Eigen::Lower>();
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(6 * nodes_, columns);  // -h_nodes T
  Eigen::MatrixXd by_calibration = Eigen::MatrixXd::Zero(6 * nodes_, calibration_);
  for (int i = 0; i < frames_; ++i) {
    for (const Part& part : follows_[static_cast<size_t>(i)])
      subtractProduct(of_nodes.middleCols<6>(6 * i), part.by_pose.transpose(),
                      half.middleCols<6>(part.column));
    if (calibration_ > 0) by_calibration.middleRows<6>(6 * i) = first_.placement(i).by_calibration;
  }
  half.middleCols(poses_, others_) = -of_nodes.middleCols(6 * frames_, others_);
  subtractProduct(of_nodes, by_calibration.transpose(), half.rightCols(calibration_));
  h->setZero(columns, columns);
  g->setZero(columns);
  for (int i = 0; i < frames_; ++i) {
    for (const Part& part : follows_[static_cast<size_t>(i)]) {
      h->middleRows<6>(part.column).noalias() -= part.by_pose.transpose() * half.middleRows<6>(6 * i);
      g->segment<6>(part.column).noalias() += part.by_pose.transpose() * g_nodes.segment<6>(6 * i);
    }
  }
  h->middleRows(poses_, others_) = -half.middleRows(6 * frames_, others_);
  g->segment(poses_, others_) = g_nodes.segment(6 * frames_, others_);
  h->bottomRows(calibration_).noalias() = -by_calibration.transpose() * half;
  g->tail(calibration_).noalias() = by_calibration.transpose() * g_nodes;
}

Eigen::VectorXd NodeBlocks::stepOfNodes(const NormalEquations& system, const Eigen::VectorXd& step) const {
  Eigen::VectorXd of_blocks(poses_ + others_ + calibration_);
  for (const NormalEquations::Block& block : blocks_) {
    const int size = block.tangentSize();
    of_blocks.segment(block.offset, size) = step.segment(system.find(block.value)->offset, size);
  }
  Eigen::VectorXd steps = Eigen::VectorXd::Zero(6 * nodes_);
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
