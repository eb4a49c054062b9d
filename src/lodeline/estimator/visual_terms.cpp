#include "lodeline/estimator/visual_terms.h"

#include <algorithm>
#include <cmath>

#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/geometry/so3.h"

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
  Mat26 by_host;     ///< the pose of the host's camera 0; of no meaning in the host frame
  Mat26 by_further;  ///< of no meaning for camera 0
  Mat26 by_lens;     ///< of no meaning where lenses are not estimated
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
  const Mat23 by_direction = by_point * seen.rotation;
  term.by_landmark << by_direction * landmark.base.tangent_C, by_point * seen.translation;

  if (sighting.camera > 0) {
    const CameraViews::Further& further = first_.further(sighting.camera);
    const CameraViews::Relative& camera0 = first_.relative(landmark.host, sighting.frame, 0);
    const Vec3 offset_C0 = camera0.rotation * direction + rho * (camera0.translation - further.position_C0);
    const Mat23 by_point_C0 = by_point * further.camera0_from_camera.transpose();
    term.by_further << timesSkew(by_point_C0, offset_C0) * further.left_jacobian, -rho * by_point_C0;
  }
  if (sighting.frame == landmark.host) return term;
  const Mat3& world_from_host = first_.placement(landmark.host).world_from_camera;
  const Mat23 by_world = by_direction * world_from_host.transpose();
  term.by_host << rho * by_world, -timesSkew(by_world, world_from_host * direction);
  return term;
}

void VisualTerms::eliminate(size_t index) {
  Landmark& landmark = landmarks_[index];
  auto coupling = couplings_.middleCols<kLandmarkSize>(kLandmarkSize * static_cast<Eigen::Index>(index));
  Mat3 h_landmark = Mat3::Zero();
  Vec3 g_landmark = Vec3::Zero();
  for (size_t i = landmark.first_sighting; i < landmark.end_sighting; ++i) {
    const Sighting& sighting = sightings_[i];
    const Linearised term = linearise(landmark, sighting);
    h_landmark.noalias() += term.by_landmark.transpose() * term.by_landmark;
    g_landmark.noalias() += term.by_landmark.transpose() * term.residual;
    const bool in_host = sighting.frame == landmark.host;
    const int pair_index = pairOf(landmark.host, sighting.frame);
    if (!in_host) {
      Pair& pair = pairs_[static_cast<size_t>(pair_index)];
      pair.is_seen = true;
      pair.hessian.noalias() += term.by_host.transpose() * term.by_host;
      pair.gradient.noalias() += term.by_host.transpose() * term.residual;
      coupling.middleRows<6>(6 * sighting.frame).noalias() += term.by_host.transpose() * term.by_landmark;
    }
    if (!states_) continue;
    const auto addCalibration = [&](int node, const Mat26& by_node) {
      gradient_.segment<6>(6 * node).noalias() += by_node.transpose() * term.residual;
      coupling.middleRows<6>(6 * node).noalias() += by_node.transpose() * term.by_landmark;
      hessian_.block<6, 6>(6 * node, 6 * node).noalias() += by_node.transpose() * by_node;
      if (in_host) return;
      calibration_.block<6, 6>(6 * (node - frames_), 6 * pair_index).noalias() +=
          by_node.transpose() * term.by_host;
    };
    if (sighting.camera > 0) addCalibration(furtherNode(sighting.camera), term.by_further);
    if (states_.intrinsics.empty()) continue;
    const int lens = lensNode(sighting.camera);
    addCalibration(lens, term.by_lens);
    if (sighting.camera > 0)
      hessian_.block<6, 6>(6 * lens, 6 * furtherNode(sighting.camera)).noalias() +=
          term.by_lens.transpose() * term.by_further;
  }
  auto of_host = coupling.middleRows<6>(6 * landmark.host);
  for (int frame = 0; frame < frames_; ++frame) {
    if (frame == landmark.host) continue;
    auto of_target = coupling.middleRows<6>(6 * frame);
    of_host += of_target;
    of_target.bottomRows<3>() += so3::skew(baseline_W(landmark.host, frame)) * of_target.topRows<3>();
    of_target = -of_target;
  }
  landmark.inverse_root = landmarkInverseRoot(h_landmark);
  coupling *= landmark.inverse_root;
  rooted_gradients_.segment<kLandmarkSize>(kLandmarkSize * static_cast<Eigen::Index>(index)) =
      landmark.inverse_root.transpose() * g_landmark;
}

void VisualTerms::addPairs() {
  const auto block = [&](int row, int column) { return hessian_.block<6, 6>(6 * row, 6 * column); };
  for (int host = 0; host < frames_; ++host) {
    for (int target = 0; target < frames_; ++target) {
      const Pair& pair = pairs_[static_cast<size_t>(pairOf(host, target))];
      if (!pair.is_seen) continue;
      Mat6 host_from_target = -Mat6::Identity();
      host_from_target.topRightCorner<3, 3>() = so3::skew(baseline_W(host, target));
      const Mat6 crossed = pair.hessian * host_from_target;
      block(host, host) += pair.hessian;
      block(target, target).noalias() += host_from_target.transpose() * crossed;
      if (host > target) {
        block(host, target) += crossed;
      } else {
        block(target, host) += crossed.transpose();
      }
      gradient_.segment<6>(6 * host) += pair.gradient;
      gradient_.segment<6>(6 * target).noalias() += host_from_target.transpose() * pair.gradient;
      const auto calibration = calibration_.middleCols<6>(6 * pairOf(host, target));
      hessian_.block(6 * frames_, 6 * host, calibration.rows(), 6) += calibration;
      hessian_.block(6 * frames_, 6 * target, calibration.rows(), 6).noalias() +=
          calibration * host_from_target;
    }
  }
}

void VisualTerms::addTo(NormalEquations* system) {
  values_.update();
  first_.update();
  const int rows = 6 * nodes_;
  const auto columns = kLandmarkSize * static_cast<Eigen::Index>(landmarks_.size());
  pairs_.assign(static_cast<size_t>(frames_ * frames_), Pair());
  calibration_.setZero(6 * (nodes_ - frames_), 6 * frames_ * frames_);
  hessian_.setZero(rows, rows);
  gradient_.setZero(rows);
  couplings_.setZero(rows, columns);
  rooted_gradients_.resize(columns);
  for (size_t i = 0; i < landmarks_.size(); ++i) eliminate(i);
  addPairs();
  hessian_.selfadjointView<Eigen::Lower>().rankUpdate(couplings_, -1.0);
  gradient_.noalias() -= couplings_ * rooted_gradients_;
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
  const Eigen::MatrixXd of_nodes = hessian_.selfadjointView<Eigen::Lower>();
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
  g.head(rows) = gradient_;
  for (int i = 0; i < frames_; ++i) {
    const Mat6& by_body = first_.placement(i).by_body;
    h.middleRows<6>(6 * i).noalias() = by_body.transpose() * half.middleRows<6>(6 * i);
    g.segment<6>(6 * i).noalias() = by_body.transpose() * gradient_.segment<6>(6 * i);
  }
  h.bottomRows(calibration).noalias() = by_calibration.transpose() * half;
  g.tail(calibration).noalias() = by_calibration.transpose() * gradient_;
  system->add(blocks, h, g);
}

void VisualTerms::stepLandmarks(const NormalEquations& system, const Eigen::VectorXd& step) {
  const auto stepOf = [&](const double* value) -> Vec6 {
    return step.segment<6>(system.find(value)->offset);
  };
  Eigen::VectorXd steps(6 * nodes_);
  Eigen::Matrix<double, 7, 1> calibration = Eigen::Matrix<double, 7, 1>::Zero();
  if (states_) {
    calibration.head<kExtrinsicsSize>() =
        step.segment<kExtrinsicsSize>(system.find(states_.camera0->value.data())->offset);
    calibration[kExtrinsicsSize] = step[system.find(states_.time_offset->value.data())->offset];
  }
  for (int i = 0; i < frames_; ++i) {
    const CameraViews::Placement& placement = first_.placement(i);
    const double* pose = window_.frames()[static_cast<size_t>(i)]->pose.data();
    steps.segment<6>(6 * i) = placement.by_body * stepOf(pose) + placement.by_calibration * calibration;
  }
  int node = frames_;
  for (const auto* states : {&states_.further, &states_.intrinsics}) {
    for (const GlobalState* state : *states) steps.segment<6>(6 * node++) = stepOf(state->value.data());
  }
  const Eigen::VectorXd rooted = rooted_gradients_ + couplings_.transpose() * steps;
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    Eigen::Map<Vec3>(landmarks_[i].value) -=
        landmarks_[i].inverse_root *
        rooted.segment<kLandmarkSize>(kLandmarkSize * static_cast<Eigen::Index>(i));
  }
}

}  // namespace lodeline
