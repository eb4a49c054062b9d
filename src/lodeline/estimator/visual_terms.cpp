#include "lodeline/estimator/visual_terms.h"

#include <algorithm>
#include <cmath>

#include "lodeline/factors/intrinsics_factor.h"

namespace lodeline {
namespace {

using Mat26 = Eigen::Matrix<double, 2, 6>;

/// v^T [a]x for both rows v^T of a 2x3 matrix.
Mat23 timesSkew(const Mat23& rows, const Vec3& a) {
  Mat23 product;
  product.row(0) = rows.row(0).cross(a);
  product.row(1) = rows.row(1).cross(a);
  return product;
}

}  // namespace

/// One sighting's residual and derivatives, scaled by the loss.
struct VisualTerms::Linearised {
  Vec2 residual;
  Mat23 by_landmark;
  Mat26 by_host, by_target;  ///< the poses of the two frames' cameras 0; of no meaning in the host frame
  Mat26 by_further;          ///< of no meaning for camera 0
  Mat26 by_lens;             ///< of no meaning where lenses are not estimated
};

VisualTerms::VisualTerms(Window& window, const FactorMaker& factors)
    : window_(window),
      states_(cameraStates(window)),
      values_(window, states_, factors, CameraViews::At::kValues),
      first_(window, states_, factors, CameraViews::At::kFirstEstimates),
      frames_(static_cast<int>(window.frames().size())),
      nodes_(frames_ + factors.cameraCount() - 1 + static_cast<int>(states_.intrinsics.size())) {
  const auto indexOf = [&](FrameId id) {
    const auto& frames = window.frames();
    const auto found = std::lower_bound(frames.begin(), frames.end(), id,
                                        [](const auto& frame, FrameId wanted) { return frame->id < wanted; });
    return static_cast<int>(found - frames.begin());
  };
  for (auto& [id, track] : window.tracks()) {
    if (!track.landmark) continue;
    Landmark landmark{};
    landmark.value = track.landmark->parameters.data();
    landmark.host = indexOf(track.landmark->host);
    landmark.base = track.landmark->base;
    landmark.first_sighting = sightings_.size();
    for (const lodeline::Sighting& sighting : track.sightings) {
      const int frame = indexOf(sighting.frame);
      const double scale = factors.robustScale(*window.frames()[static_cast<size_t>(frame)]);
      sightings_.push_back({frame, sighting.camera, &sighting.measurement, scale * scale});
    }
    landmark.end_sighting = sightings_.size();
    landmarks_.push_back(landmark);
  }
}

Vec2 VisualTerms::residual(const Landmark& landmark, const Sighting& sighting) const {
  const CameraViews::Relative& seen = values_.relative(landmark.host, sighting.frame, sighting.camera);
  const Vec3 point_C =
      seen.rotation * landmark.base.direction(landmark.value) + landmark.value[2] * seen.translation;
  Vec2 residual = directionResidual(*sighting.measurement, point_C, nullptr);
  if (!states_.intrinsics.empty()) {
    const std::vector<double>& lens = states_.intrinsics[static_cast<size_t>(sighting.camera)]->value;
    residual += residualByIntrinsics(*sighting.measurement) * Eigen::Map<const Vec6>(lens.data());
  }
  return residual;
}

double VisualTerms::cost() {
  values_.update();
  double sum = 0.0;
  for (const Landmark& landmark : landmarks_) {
    for (size_t i = landmark.first_sighting; i < landmark.end_sighting; ++i) {
      const double squared = residual(landmark, sightings_[i]).squaredNorm();
      sum += sightings_[i].scale_squared * std::log1p(squared / sightings_[i].scale_squared);
    }
  }
  return 0.5 * sum;
}

std::vector<double> VisualTerms::errors() const {
  std::vector<double> errors;
  errors.reserve(sightings_.size());
  for (const Landmark& landmark : landmarks_) {
    for (size_t i = landmark.first_sighting; i < landmark.end_sighting; ++i)
      errors.push_back(residual(landmark, sightings_[i]).norm());
  }
  return errors;
}

VisualTerms::Linearised VisualTerms::linearise(const Landmark& landmark, const Sighting& sighting) const {
  const double rho = landmark.value[2];
  const Vec3 direction = landmark.base.direction(landmark.value);
  const CameraViews::Relative& seen = first_.relative(landmark.host, sighting.frame, sighting.camera);
  Linearised term;
  term.residual = residual(landmark, sighting);
  Mat23 by_point;
  directionResidual(*sighting.measurement, seen.rotation * direction + rho * seen.translation, &by_point);
  const double weight = 1.0 / std::sqrt(1.0 + term.residual.squaredNorm() / sighting.scale_squared);
  term.residual *= weight;
  by_point *= weight;
  if (!states_.intrinsics.empty()) term.by_lens = weight * residualByIntrinsics(*sighting.measurement);
  term.by_landmark << by_point * seen.rotation * landmark.base.tangent_C, by_point * seen.translation;

  const CameraViews::Placement& host = first_.placement(landmark.host);
  const CameraViews::Placement& target = first_.placement(sighting.frame);
  Mat23 by_point_C0 = by_point;
  if (sighting.camera > 0) {
    const CameraViews::Further& further = first_.further(sighting.camera);
    const CameraViews::Relative& camera0 = first_.relative(landmark.host, sighting.frame, 0);
    const Vec3 offset_C0 = camera0.rotation * direction + rho * (camera0.translation - further.position_C0);
    by_point_C0 = by_point * further.camera0_from_camera.transpose();
    term.by_further << timesSkew(by_point_C0, offset_C0) * further.left_jacobian, -rho * by_point_C0;
  }
  if (sighting.frame == landmark.host) return term;
  const Mat23 by_world = by_point_C0 * target.world_from_camera.transpose();
  const Vec3 from_host_W = host.world_from_camera * direction;
  const Vec3 from_target_W = from_host_W + rho * (host.position_W - target.position_W);
  term.by_host << rho * by_world, -timesSkew(by_world, from_host_W);
  term.by_target << -rho * by_world, timesSkew(by_world, from_target_W);
  return term;
}

Mat6& VisualTerms::hessian(int row, int column) {
  return hessian_[static_cast<size_t>(row * (row + 1) / 2 + column)];
}

void VisualTerms::addProduct(int a, const Mat26& by_a, int b, const Mat26& by_b) {
  if (a >= b) {
    hessian(a, b).noalias() += by_a.transpose() * by_b;
  } else {
    hessian(b, a).noalias() += by_b.transpose() * by_a;
  }
}

VisualTerms::Coupling& VisualTerms::couplingOf(const Landmark& landmark, int node) {
  for (size_t i = landmark.first_coupling; i < couplings_.size(); ++i) {
    if (couplings_[i].node == node) return couplings_[i];
  }
  return couplings_.emplace_back(Coupling{node, Mat63::Zero()});
}

void VisualTerms::eliminate(Landmark* landmark) {
  Mat3 h_landmark = Mat3::Zero();
  Vec3 g_landmark = Vec3::Zero();
  landmark->first_coupling = couplings_.size();
  const auto addNode = [&](int node, const Mat26& by_node, const Linearised& term) {
    gradient_[static_cast<size_t>(node)].noalias() += by_node.transpose() * term.residual;
    couplingOf(*landmark, node).by_landmark.noalias() += by_node.transpose() * term.by_landmark;
    addProduct(node, by_node, node, by_node);
  };
  for (size_t i = landmark->first_sighting; i < landmark->end_sighting; ++i) {
    const Sighting& sighting = sightings_[i];
    const Linearised term = linearise(*landmark, sighting);
    h_landmark.noalias() += term.by_landmark.transpose() * term.by_landmark;
    g_landmark.noalias() += term.by_landmark.transpose() * term.residual;
    const bool in_host = sighting.frame == landmark->host;
    if (!in_host) {
      addNode(landmark->host, term.by_host, term);
      addNode(sighting.frame, term.by_target, term);
      addProduct(landmark->host, term.by_host, sighting.frame, term.by_target);
    }
    if (!states_) continue;
    const auto addCalibration = [&](int node, const Mat26& by_node) {
      addNode(node, by_node, term);
      if (in_host) return;
      addProduct(node, by_node, landmark->host, term.by_host);
      addProduct(node, by_node, sighting.frame, term.by_target);
    };
    if (sighting.camera > 0) addCalibration(furtherNode(sighting.camera), term.by_further);
    if (states_.intrinsics.empty()) continue;
    addCalibration(lensNode(sighting.camera), term.by_lens);
    if (sighting.camera > 0)
      addProduct(lensNode(sighting.camera), term.by_lens, furtherNode(sighting.camera), term.by_further);
  }
  landmark->end_coupling = couplings_.size();
  landmark->inverse_hessian = landmarkInverse(h_landmark);
  landmark->gradient = g_landmark;
  for (size_t i = landmark->first_coupling; i < landmark->end_coupling; ++i) {
    const Coupling& row = couplings_[i];
    const Mat63 weighted = row.by_landmark * landmark->inverse_hessian;
    gradient_[static_cast<size_t>(row.node)].noalias() -= weighted * g_landmark;
    for (size_t j = landmark->first_coupling; j < landmark->end_coupling; ++j) {
      const Coupling& column = couplings_[j];
      if (column.node <= row.node)
        hessian(row.node, column.node).noalias() -= weighted * column.by_landmark.transpose();
    }
  }
}

void VisualTerms::addTo(NormalEquations* system) {
  values_.update();
  first_.update();
  hessian_.assign(static_cast<size_t>(nodes_ * (nodes_ + 1) / 2), Mat6::Zero());
  gradient_.assign(static_cast<size_t>(nodes_), Vec6::Zero());
  couplings_.clear();
  for (Landmark& landmark : landmarks_) eliminate(&landmark);
  addNodesTo(system);
}

std::vector<NormalEquations::Block> VisualTerms::blocks() const {
  std::vector<NormalEquations::Block> blocks;
  int offset = 0;
  const auto append = [&](double* value, int size) {
    blocks.push_back({value, size, offset});
    offset += blocks.back().tangentSize();
  };
  for (const auto& frame : window_.frames()) append(frame->pose.data(), kPoseSize);
  if (!states_) return blocks;
  for (GlobalState* state : states_.further) append(state->value.data(), kExtrinsicsSize);
  for (GlobalState* state : states_.intrinsics) append(state->value.data(), kIntrinsicsSize);
  append(states_.camera0->value.data(), kExtrinsicsSize);
  append(states_.time_offset->value.data(), kTimeOffsetSize);
  return blocks;
}

/// From nodes to the blocks that they come from: H = T^T H_nodes T, T made of the placements' derivatives.
void VisualTerms::addNodesTo(NormalEquations* system) const {
  const std::vector<NormalEquations::Block> blocks = this->blocks();
  const int rows = 6 * nodes_;
  const int calibration = states_ ? kExtrinsicsSize + kTimeOffsetSize : 0;
  Eigen::MatrixXd of_nodes(rows, rows);
  Eigen::VectorXd gradient_of_nodes(rows);
  for (int i = 0; i < nodes_; ++i) {
    gradient_of_nodes.segment<6>(6 * i) = gradient_[static_cast<size_t>(i)];
    for (int j = 0; j <= i; ++j) {
      const Mat6& block = hessian_[static_cast<size_t>(i * (i + 1) / 2 + j)];
      of_nodes.block<6, 6>(6 * i, 6 * j) = block;
      of_nodes.block<6, 6>(6 * j, 6 * i) = block.transpose();
    }
  }
  Eigen::MatrixXd half(rows, rows + calibration);  // H_nodes T
  Eigen::MatrixXd by_calibration = Eigen::MatrixXd::Zero(rows, calibration);
  half.leftCols(rows) = of_nodes;
  for (int i = 0; i < frames_; ++i) {
    half.middleCols<6>(6 * i).noalias() = of_nodes.middleCols<6>(6 * i) * first_.placement(i).by_body;
    if (calibration > 0) by_calibration.middleRows<6>(6 * i) = first_.placement(i).by_calibration;
  }
  half.rightCols(calibration).noalias() = of_nodes * by_calibration;
  Eigen::MatrixXd h(rows + calibration, rows + calibration);
  Eigen::VectorXd g(rows + calibration);
  h.topRows(rows) = half;
  g.head(rows) = gradient_of_nodes;
  for (int i = 0; i < frames_; ++i) {
    const Mat6& by_body = first_.placement(i).by_body;
    h.middleRows<6>(6 * i).noalias() = by_body.transpose() * half.middleRows<6>(6 * i);
    g.segment<6>(6 * i).noalias() = by_body.transpose() * gradient_of_nodes.segment<6>(6 * i);
  }
  h.bottomRows(calibration).noalias() = by_calibration.transpose() * half;
  g.tail(calibration).noalias() = by_calibration.transpose() * gradient_of_nodes;
  system->add(blocks, h, g);
}

void VisualTerms::stepLandmarks(const NormalEquations& system, const Eigen::VectorXd& step) {
  const auto stepOf = [&](const double* value) -> Vec6 {
    return step.segment<6>(system.find(value)->offset);
  };
  std::vector<Vec6> steps(static_cast<size_t>(nodes_), Vec6::Zero());
  Eigen::Matrix<double, 7, 1> calibration = Eigen::Matrix<double, 7, 1>::Zero();
  if (states_) {
    calibration.head<kExtrinsicsSize>() =
        step.segment<kExtrinsicsSize>(system.find(states_.camera0->value.data())->offset);
    calibration[kExtrinsicsSize] = step[system.find(states_.time_offset->value.data())->offset];
    for (size_t i = 0; i < states_.further.size(); ++i)
      steps[static_cast<size_t>(frames_) + i] = stepOf(states_.further[i]->value.data());
    for (size_t i = 0; i < states_.intrinsics.size(); ++i)
      steps[static_cast<size_t>(lensNode(static_cast<int>(i)))] = stepOf(states_.intrinsics[i]->value.data());
  }
  for (int i = 0; i < frames_; ++i) {
    const CameraViews::Placement& placement = first_.placement(i);
    const double* pose = window_.frames()[static_cast<size_t>(i)]->pose.data();
    steps[static_cast<size_t>(i)] = placement.by_body * stepOf(pose) + placement.by_calibration * calibration;
  }
  for (const Landmark& landmark : landmarks_) {
    Vec3 gradient = landmark.gradient;
    for (size_t i = landmark.first_coupling; i < landmark.end_coupling; ++i) {
      gradient.noalias() +=
          couplings_[i].by_landmark.transpose() * steps[static_cast<size_t>(couplings_[i].node)];
    }
    Eigen::Map<Vec3>(landmark.value) -= landmark.inverse_hessian * gradient;
  }
}

}  // namespace lodeline
