#include "lodeline/estimator/visual/reprojection_system.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Columns = ObservationColumns;

/// v^T [a]x for both rows v^T of a 2x3 matrix.
Mat23 timesSkew(const Mat23& rows, const Vec3& a) {
  Mat23 product;
  product.row(0) = rows.row(0).cross(a);
  product.row(1) = rows.row(1).cross(a);
  return product;
}

std::vector<FrameId> idsOf(const Window& window) {
  std::vector<FrameId> ids;
  for (const auto& frame : window.frames()) ids.push_back(frame->id);
  return ids;
}

/// Index of a frame, counted from the oldest.
int placeOf(FrameId id, const std::vector<FrameId>& ids) {
  return static_cast<int>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

bool isAmong(const FeatureTrack& track, ReprojectionSystem::Of which) {
  return track.landmark && (which == ReprojectionSystem::Of::kAll ||
                            track.is_frozen == (which == ReprojectionSystem::Of::kFrozen));
}

/// The frames that are hosts of landmarks, counted from the oldest.
std::vector<int> hostsOf(const Window& window, ReprojectionSystem::Of which) {
  const std::vector<FrameId> ids = idsOf(window);
  std::vector<bool> is_host(ids.size(), false);
  for (const auto& [id, track] : window.tracks()) {
    if (isAmong(track, which)) is_host[static_cast<size_t>(placeOf(track.landmark->host, ids))] = true;
  }
  std::vector<int> hosts;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (is_host[i]) hosts.push_back(static_cast<int>(i));
  }
  return hosts;
}

/// Converts derivatives by the pose of a host's camera (columns) to those by a target's, at the baseline from
/// target to host. A motion of one is the reverse motion of the other.
template <int kRows>
Eigen::Matrix<double, kRows, 6> byTarget(const Eigen::Matrix<double, kRows, 6>& by_host,
                                         const Vec3& baseline_W) {
  const Eigen::Matrix<double, kRows, 3> by_position = by_host.template leftCols<3>();
  Eigen::Matrix<double, kRows, 6> by_target;
  by_target << -by_position, by_position * so3::skew(baseline_W) - by_host.template rightCols<3>();
  return by_target;
}

}  // namespace

/// Residual and derivatives of one observation, scaled by the loss.
struct ReprojectionSystem::Linearized {
  ObservationRows by_nodes = ObservationRows::Zero();
  Mat23 by_landmark;

  auto residual() const { return by_nodes.col(Columns::kResidual); }
  template <int kSize = 6>
  auto by(int column) const {
    return by_nodes.middleCols<kSize>(column);
  }
  template <int kSize = 6>
  auto by(int column) {
    return by_nodes.middleCols<kSize>(column);
  }
};

ReprojectionSystem::ReprojectionSystem(Window& window, const FactorBuilder& factors, Of which,
                                       std::optional<FrameId> only)
    : states_(cameraStates(window)),
      values_(window, states_, factors, CameraViews::At::kValues, hostsOf(window, which)),
      first_(window, states_, factors, CameraViews::At::kLinearizationPoints, values_.hosts()),
      frames_(static_cast<int>(window.frames().size())),
      cameras_(factors.cameraCount()),
      rows_(6 * (frames_ + cameras_ - 1) + kIntrinsicsSize * static_cast<int>(states_.intrinsics.size()) +
            (states_.shutter ? kShutterSize : 0)),
      blocks_(window, states_, first_, rows_) {
  const std::vector<FrameId> ids = idsOf(window);
  std::vector<double> scales;
  for (const auto& frame : window.frames()) scales.push_back(factors.robustScale(*frame));
  for (auto& [id, track] : window.tracks()) {
    if (isAmong(track, which)) add(track, only, ids, scales);
  }
  arrangeColumns();
  if (states_.shutter) prepareShutter(window, factors);
  update();
}

void ReprojectionSystem::add(FeatureTrack& track, std::optional<FrameId> only,
                             const std::vector<FrameId>& ids, const std::vector<double>& scales) {
  Landmark landmark{};
  landmark.value = track.landmark->parameters.data();
  landmark.host = placeOf(track.landmark->host, ids);
  landmark.base = track.landmark->base;
  landmark.weight = track.weight;
  landmark.first_frame = landmark.host;
  landmark.end_frame = landmark.host + 1;
  landmark.first_observation = observations_.size();
  const std::span<const lodeline::Observation> all(track.observations);
  int frame = 0;
  for (const lodeline::Observation& observation : only ? track.in(*only) : all) {
    // Observations are in order of time.
    while (ids[static_cast<size_t>(frame)] < observation.frame) ++frame;
    landmark.first_frame = std::min(landmark.first_frame, frame);
    landmark.end_frame = std::max(landmark.end_frame, frame + 1);
    const double scale = scales[static_cast<size_t>(frame)];
    observations_.push_back(
        {frame, observation.camera, &observation.measurement, scale * scale, &observation.measurement});
  }
  landmark.end_observation = observations_.size();
  landmarks_.push_back(landmark);
}

/// Orders the columns by the time at which landmarks were observed. Most landmarks are observed by some
/// frames of the window only, so that a stretch of such columns involves few more frames than each landmark.
void ReprojectionSystem::arrangeColumns() {
  constexpr size_t kStretch = 16;
  std::vector<Landmark*> by_time;
  for (Landmark& landmark : landmarks_) by_time.push_back(&landmark);
  std::stable_sort(by_time.begin(), by_time.end(), [](const Landmark* a, const Landmark* b) {
    return std::pair(a->end_frame, a->first_frame) < std::pair(b->end_frame, b->first_frame);
  });
  for (size_t i = 0; i < by_time.size(); ++i) {
    Landmark& landmark = *by_time[i];
    landmark.column = kLandmarkSize * static_cast<Eigen::Index>(i);
    if (i % kStretch == 0)
      stretches_.push_back({{}, landmark.column, 0, landmark.first_frame, landmark.end_frame});
    Stretch& stretch = stretches_.back();
    stretch.landmarks.push_back(&landmark);
    stretch.columns += kLandmarkSize;
    stretch.first_frame = std::min(stretch.first_frame, landmark.first_frame);
    stretch.end_frame = std::max(stretch.end_frame, landmark.end_frame);
  }
}

void ReprojectionSystem::update() {
  values_.update();
  if (states_.shutter) moveMeasurements();
  residuals_.resize(observations_.size());
  for (const Landmark& landmark : landmarks_) {
    const Vec3 direction = landmark.base.direction(landmark.value);
    const double rho = landmark.value[2];
    for (size_t i = landmark.first_observation; i < landmark.end_observation; ++i) {
      const Observation& observation = observations_[i];
      const CameraViews::Relative& seen =
          values_.relative(landmark.host, observation.frame, observation.camera);
      const Vec3 point_C =
          observation.measurement->fromOrigin(seen.rotation * direction + rho * seen.translation, rho);
      Residual& residual = residuals_[i];
      residual.by_file = residual.by_intrinsics =
          directionResidual(*observation.measurement, point_C, nullptr);
      if (states_.intrinsics.empty()) continue;
      residual.by_intrinsics +=
          intrinsicsShift(*observation.measurement, residual.by_file, intrinsicsOf(observation.camera));
    }
  }
}

double ReprojectionSystem::cost() const {
  double sum = 0.0;
  for (const Landmark& landmark : landmarks_) {
    double of_landmark = 0.0;
    for (size_t i = landmark.first_observation; i < landmark.end_observation; ++i) {
      const double squared = residuals_[i].by_intrinsics.squaredNorm();
      of_landmark += observations_[i].scale_squared * std::log1p(squared / observations_[i].scale_squared);
    }
    sum += landmark.weight * of_landmark;
  }
  return 0.5 * sum;
}

std::vector<double> ReprojectionSystem::errors() const {
  std::vector<double> errors;
  errors.reserve(residuals_.size());
  for (const Residual& residual : residuals_) errors.push_back(residual.by_intrinsics.norm());
  return errors;
}

std::vector<double*> ReprojectionSystem::landmarks() const {
  std::vector<double*> landmarks;
  landmarks.reserve(landmarks_.size());
  for (const Landmark& landmark : landmarks_) landmarks.push_back(landmark.value);
  return landmarks;
}

ReprojectionSystem::Linearized ReprojectionSystem::linearize(const Landmark& landmark,
                                                             const Observation& observation,
                                                             const Residual& residual) const {
  const double rho = landmark.value[2];
  const Vec3 direction = landmark.base.direction(landmark.value);
  const CameraViews::Relative& seen = first_.relative(landmark.host, observation.frame, observation.camera);
  Linearized term;
  Mat23 by_point;
  const DirectionMeasurement& measurement = *observation.measurement;
  directionResidual(measurement,
                    measurement.fromOrigin(seen.rotation * direction + rho * seen.translation, rho),
                    &by_point);
  if (!states_.intrinsics.empty()) {
    const IntrinsicsEffect lens =
        intrinsicsEffect(*observation.measurement, residual.by_file, intrinsicsOf(observation.camera));
    by_point = (lens.by_residual * by_point).eval();
    term.by<kIntrinsicsSize>(Columns::kIntrinsics) = lens.by_intrinsics;
  }
  if (states_.shutter) {
    term.by_nodes.col(Columns::kLineDelay) =
        by_point * pointByLineDelay(*observation.as_measured, motionOf(observation),
                                    lineDelay_s(observation.camera),
                                    seen.rotation * direction + rho * seen.translation, rho);
  }
  const double weight =
      std::sqrt(landmark.weight / (1.0 + residual.by_intrinsics.squaredNorm() / observation.scale_squared));
  term.by_nodes.col(Columns::kResidual) = weight * residual.by_intrinsics;
  by_point *= weight;
  const Mat23 by_direction = by_point * seen.rotation;
  term.by_landmark << by_direction * landmark.base.tangent_C,
      by_point * (seen.translation - measurement.origin_C);

  term.by<kIntrinsicsSize>(Columns::kIntrinsics) *= weight;
  term.by_nodes.col(Columns::kLineDelay) *= weight;
  if (observation.camera > 0) {
    const CameraViews::Further& secondary = first_.secondary(observation.camera);
    const CameraViews::Relative& camera0 = first_.relative(landmark.host, observation.frame, 0);
    const Vec3 offset_C0 = camera0.rotation * direction + rho * (camera0.translation - secondary.position_C0);
    const Mat23 by_point_C0 = by_point * secondary.camera0_from_camera.transpose();
    term.by(Columns::kSecondary) << timesSkew(by_point_C0, offset_C0) * secondary.left_jacobian,
        -rho * by_point_C0;
  }
  if (observation.frame == landmark.host) return term;
  const Mat3& world_from_host = first_.placement(landmark.host).world_from_camera;
  const Mat23 by_world = by_direction * world_from_host.transpose();
  term.by(Columns::kHost) << rho * by_world, -timesSkew(by_world, world_from_host * direction);
  return term;
}

void ReprojectionSystem::eliminate(Landmark* of) {
  Landmark& landmark = *of;
  auto coupling = couplings_.middleCols<kLandmarkSize>(landmark.column);
  Mat3 h_landmark = Mat3::Zero();
  Vec3 g_landmark = Vec3::Zero();
  for (size_t i = landmark.first_observation; i < landmark.end_observation; ++i) {
    const Observation& observation = observations_[i];
    const Linearized term = linearize(landmark, observation, residuals_[i]);
    h_landmark.noalias() += term.by_landmark.transpose() * term.by_landmark;
    g_landmark.noalias() += term.by_landmark.transpose() * term.residual();
    const auto couple = [&](int row, const auto& by_node) {
      coupling.middleRows<std::decay_t<decltype(by_node)>::ColsAtCompileTime>(row).noalias() +=
          by_node.transpose() * term.by_landmark;
    };
    if (observation.frame != landmark.host) {
      addProducts(term.by_nodes, &by_host_[indexOf(landmark.host, observation.frame, observation.camera)]);
      couple(6 * observation.frame, term.by(Columns::kHost));
    }
    if (!states_) continue;
    addProducts(term.by_nodes, &by_calibration_[static_cast<size_t>(observation.camera)]);
    if (observation.camera > 0) couple(secondaryRow(observation.camera), term.by(Columns::kSecondary));
    if (!states_.intrinsics.empty())
      couple(intrinsicsRow(observation.camera), term.by<kIntrinsicsSize>(Columns::kIntrinsics));
    if (states_.shutter) {
      const Vec2 by_line_delay = term.by_nodes.col(Columns::kLineDelay);
      coupling.row(shutterRow() + observation.camera) += by_line_delay.transpose() * term.by_landmark;
      shutter_products_[static_cast<size_t>(observation.camera)] +=
          Vec2(by_line_delay.squaredNorm(), by_line_delay.dot(term.residual()));
    }
  }
  // The effect of the targets' poses follows from the host's effect with each target alone.
  auto of_host = coupling.middleRows<6>(6 * landmark.host);
  for (int frame = landmark.first_frame; frame < landmark.end_frame; ++frame) {
    if (frame == landmark.host) continue;
    auto of_target = coupling.middleRows<6>(6 * frame);
    of_host += of_target;
    of_target.bottomRows<3>() += so3::skew(baseline_W(landmark.host, frame)) * of_target.topRows<3>();
    of_target = -of_target;
  }
  landmark.inverse_root = landmarkInverseRoot(h_landmark);
  const auto root = [&](auto rows) { rows *= landmark.inverse_root; };
  root(coupling.middleRows(6 * landmark.first_frame, 6 * (landmark.end_frame - landmark.first_frame)));
  root(coupling.bottomRows(rows_ - 6 * frames_));
  rooted_gradients_.segment<kLandmarkSize>(landmark.column) = landmark.inverse_root.transpose() * g_landmark;
}

void ReprojectionSystem::addPair(int host, int target) {
  const auto block = [&](int row, int column) { return hessian_.block<6, 6>(6 * row, 6 * column); };
  const Vec3 baseline_W = this->baseline_W(host, target);
  HostProducts sum = HostProducts::Zero();
  const auto addCalibration = [&](int row, const auto& by_host) {
    constexpr int kRows = std::decay_t<decltype(by_host)>::RowsAtCompileTime;
    hessian_.block<kRows, 6>(row, 6 * host) += by_host;
    hessian_.block<kRows, 6>(row, 6 * target) += byTarget<kRows>(by_host, baseline_W);
  };
  for (int camera = 0; camera < cameras_; ++camera) {
    const HostProducts& of_camera = by_host_[indexOf(host, target, camera)];
    sum += of_camera;
    if (camera > 0 && states_)
      addCalibration(secondaryRow(camera), of_camera.middleCols<6>(Columns::kSecondary).transpose());
    if (!states_.intrinsics.empty())
      addCalibration(intrinsicsRow(camera),
                     of_camera.middleCols<kIntrinsicsSize>(Columns::kIntrinsics).transpose());
    if (states_.shutter) {
      Mat6 by_line_delays = Mat6::Zero();
      by_line_delays.row(camera) = of_camera.col(Columns::kLineDelay).transpose();
      addCalibration(shutterRow(), by_line_delays);
    }
  }
  const Mat6 by_host = sum.middleCols<6>(Columns::kHost);
  const Mat6 by_both = byTarget<6>(by_host, baseline_W);
  block(host, host) += by_host;
  block(target, target) += byTarget<6>(by_both.transpose(), baseline_W);
  if (host > target) {
    block(host, target) += by_both;
  } else {
    block(target, host) += by_both.transpose();
  }
  const Vec6 gradient = sum.col(Columns::kResidual);
  gradient_.segment<6>(6 * host) += gradient;
  gradient_.segment<3>(6 * target) -= gradient.head<3>();
  gradient_.segment<3>(6 * target + 3) -= gradient.tail<3>() + baseline_W.cross(gradient.head<3>());
}

void ReprojectionSystem::addCalibration(int camera) {
  const CalibrationProducts& sum = by_calibration_[static_cast<size_t>(camera)];
  const auto addNode = [&](int row, int columns, int size) {
    hessian_.block(row, row, size, size) += sum.block(columns, columns, size, size);
    gradient_.segment(row, size) += sum.col(Columns::kResidual).segment(columns, size);
  };
  if (camera > 0) addNode(secondaryRow(camera), Columns::kSecondary, kExtrinsicsSize);
  if (states_.intrinsics.empty()) return;
  addNode(intrinsicsRow(camera), Columns::kIntrinsics, kIntrinsicsSize);
  if (camera == 0) return;
  hessian_.block<kIntrinsicsSize, kExtrinsicsSize>(intrinsicsRow(camera), secondaryRow(camera)) +=
      sum.block<kIntrinsicsSize, kExtrinsicsSize>(Columns::kIntrinsics, Columns::kSecondary);
}

void ReprojectionSystem::addTo(NormalEquations* system) {
  first_.update();
  blocks_.update();
  by_host_.assign(indexOf(frames_, 0, 0), HostProducts::Zero());
  by_calibration_.assign(static_cast<size_t>(cameras_), CalibrationProducts::Zero());
  shutter_products_.assign(static_cast<size_t>(cameras_), Vec2::Zero());
  hessian_.setZero(rows_, rows_);
  gradient_.setZero(rows_);
  couplings_.resize(rows_, kLandmarkSize * static_cast<Eigen::Index>(landmarks_.size()));
  rooted_gradients_.resize(kLandmarkSize * static_cast<Eigen::Index>(landmarks_.size()));
  // Done here while a stretch's couplings are in the cache.
  for (const Stretch& stretch : stretches_) {
    couplingsOfFrames(stretch).setZero();
    couplingsOfCalibration(stretch).setZero();
    for (Landmark* landmark : stretch.landmarks) eliminate(landmark);
    subtractEliminated(stretch);
  }
  for (const int host : first_.hosts()) {
    for (int target = 0; target < frames_; ++target) {
      if (target != host) addPair(host, target);
    }
  }
  for (int camera = 0; states_ && camera < cameras_; ++camera) addCalibration(camera);
  if (states_.shutter) addShutter();
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
  blocks_.transform(hessian_, gradient_, &h, &g);
  system->add(blocks_.blocks(), h, g);
}

}  // namespace lodeline
