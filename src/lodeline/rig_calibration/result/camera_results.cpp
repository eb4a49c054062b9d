#include "lodeline/rig_calibration/result/camera_results.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/rig_calibration/start/inertial_start.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

// Errors that many corners share, by the pixel grid, the print and the lens, do not average out.
constexpr double kLeastSigma_px = 0.05;
constexpr double kMedianOfNormal = 0.6745;
constexpr double kOutlier_sigmas = 5.0;

/// Pose of a camera in W at the time of its image.
Rigid3 worldFromCamera(const FrameState& frame, const CameraState& camera) {
  const Rigid3 pose = poseFromBlock(frame.world_from_body.data());
  const Vec3 rate_B = frame.gyroscope_reading_B - Vec3(frame.motion.data() + 3);
  const double delay_s = camera.delay_change_s;
  const Rigid3 moved(pose.rotation * so3::exp(delay_s * rate_B),
                     pose.translation + delay_s * Vec3(frame.motion.data()));
  return moved * poseFromBlock(camera.body_from_camera.data());
}

template <typename Use>
void forEachError(const CalibrationBoard& board, const RigState& state, const Use& use) {
  const Rigid3 world_from_board(state.worldFromBoard(), Vec3::Zero());
  for (size_t f = 0; f < state.frames.size(); ++f) {
    for (const BoardView& view : state.frames[f].seen->views) {
      const CameraState& camera = state.cameras[view.camera];
      const Rigid3 camera_from_board = worldFromCamera(state.frames[f], camera).inverse() * world_from_board;
      for (const BoardCorner& corner : view.corners) {
        const auto pixel = camera.camera->project(camera_from_board * board.corner_T(corner.index));
        use(f, view.camera, corner, pixel ? Vec2(*pixel - corner.pixel) : Vec2(1e3, 1e3));
      }
    }
  }
}

PoseSigmas poseSigmas(const Mat6& covariance) {
  const Eigen::Matrix<double, 6, 1> sigmas = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {sigmas.tail<3>(), sigmas.head<3>()};
}

/// Sigmas of the pose of a camera on the first one, from those of both on the body.
PoseSigmas relativeSigmas(const RigState& state, const Posterior& posterior, size_t camera) {
  const Rigid3 first = poseFromBlock(state.cameras[0].body_from_camera.data());
  const Rigid3 other = poseFromBlock(state.cameras[camera].body_from_camera.data());
  const Rigid3 relative = first.inverse() * other;
  Eigen::MatrixXd by_columns = Eigen::MatrixXd::Zero(6, posterior.covariance.cols());
  const auto add = [&](int column, const Rigid3& moved_first, const Rigid3& moved_other, double step) {
    by_columns.col(column) = perturbationBetween(relative, moved_first.inverse() * moved_other) / step;
  };
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Matrix<double, 6, 1> change = kStep * Eigen::Matrix<double, 6, 1>::Unit(i);
    const int of_first = posterior.columns[0].extrinsics, of_other = posterior.columns[camera].extrinsics;
    if (of_first >= 0) add(of_first + i, perturbed(first, change), other, kStep);
    if (of_other >= 0) add(of_other + i, first, perturbed(other, change), kStep);
  }
  return poseSigmas(by_columns * posterior.covariance * by_columns.transpose());
}

std::vector<double> sigmasAt(const Posterior& posterior, int first, size_t count) {
  std::vector<double> sigmas;
  for (size_t i = 0; i < count; ++i) {
    const Eigen::Index at = first + static_cast<Eigen::Index>(i);
    sigmas.push_back(std::sqrt(std::max(0.0, posterior.covariance(at, at))));
  }
  return sigmas;
}

void setSigmas(const RigState& state, const Posterior& posterior, size_t camera, bool has_imu,
               CameraCalibrationResult* result) {
  const CameraColumns& columns = posterior.columns[camera];
  if (columns.lens >= 0)
    result->lens_sigmas = sigmasAt(posterior, columns.lens, state.cameras[camera].lens.size());
  if (columns.port >= 0) {
    const std::vector<double> sigmas = sigmasAt(posterior, columns.port, kPortSize);
    result->port_sigmas = Vec3(sigmas.data());
    if (columns.lens < 0) result->index_sigma = sigmas[3];
  }
  if (columns.delay >= 0) result->delay_sigma_s = sigmasAt(posterior, columns.delay, 1).front();
  if (camera > 0) result->first_sigmas = relativeSigmas(state, posterior, camera);
  if (has_imu && columns.extrinsics >= 0)
    result->body_sigmas =
        poseSigmas(posterior.covariance.block<6, 6>(columns.extrinsics, columns.extrinsics));
}

/// Share of the cells of the image in which corners were found.
double coverageShare(const CameraCalibrationResult& result) {
  constexpr int kColumns = 10, kRows = 8, kLeast = 3;
  int counts[kRows][kColumns] = {};
  for (const CornerError& corner : result.corners) {
    const int x = std::clamp(static_cast<int>(corner.pixel.x() * kColumns / result.calibration.width_px), 0,
                             kColumns - 1);
    const int y =
        std::clamp(static_cast<int>(corner.pixel.y() * kRows / result.calibration.height_px), 0, kRows - 1);
    ++counts[y][x];
  }
  int covered = 0;
  for (const auto& row : counts)
    covered += static_cast<int>(std::count_if(row, row + kColumns, [](int n) { return n >= kLeast; }));
  return static_cast<double>(covered) / (kColumns * kRows);
}

void setErrors(CameraCalibrationResult* result) {
  const double limit_px = kOutlier_sigmas * result->sigma_px;
  double sum = 0.0;
  size_t inliers = 0;
  for (const CornerError& corner : result->corners) {
    if (corner.error_px.norm() > limit_px) continue;
    sum += corner.error_px.squaredNorm();
    ++inliers;
  }
  if (inliers > 0) result->rms_px = std::sqrt(sum / static_cast<double>(inliers));
  const double all = static_cast<double>(std::max<size_t>(1, result->corners.size()));
  result->outlier_share = 1.0 - static_cast<double>(inliers) / all;
  result->coverage_share = coverageShare(*result);
}

}  // namespace

void settleCornerSigmas(const CalibrationBoard& board, RigState* state) {
  std::vector<std::vector<double>> errors_px(state->cameras.size());
  forEachError(board, *state, [&](size_t, size_t camera, const BoardCorner&, const Vec2& error_px) {
    errors_px[camera].push_back(std::abs(error_px.x()));
    errors_px[camera].push_back(std::abs(error_px.y()));
  });
  for (size_t k = 0; k < state->cameras.size(); ++k)
    state->cameras[k].sigma_px = std::max(kLeastSigma_px, median(errors_px[k]) / kMedianOfNormal);
}

void dropOutlyingFrames(const CalibrationBoard& board, RigState* state) {
  constexpr double kMost_sigmas = 6.0, kAlwaysGood_px = 0.5;
  std::vector<std::vector<double>> of_frame(state->frames.size());
  forEachError(board, *state, [&](size_t frame, size_t camera, const BoardCorner&, const Vec2& error_px) {
    const double size_px = error_px.norm();
    of_frame[frame].push_back(size_px < kAlwaysGood_px ? 0.0 : size_px / state->cameras[camera].sigma_px);
  });
  size_t kept = 0;
  for (size_t f = 0; f < state->frames.size(); ++f) {
    if (median(of_frame[f]) < kMost_sigmas) state->frames[kept++] = state->frames[f];
  }
  state->frames.resize(kept);
}

std::vector<CameraCalibrationResult> cameraResults(const BoardRecord& record, const RigState& state,
                                                   const Posterior& posterior, bool has_imu) {
  std::vector<CameraCalibrationResult> results(state.cameras.size());
  std::vector<std::vector<double>> tilts_rad(results.size());
  const Rigid3 first = poseFromBlock(state.cameras[0].body_from_camera.data());
  for (size_t k = 0; k < results.size(); ++k) {
    CameraCalibrationResult& result = results[k];
    result.calibration = state.cameras[k].calibration();
    result.calibration.time_offset_to_imu_s = has_imu ? state.delay_s + state.cameras[k].delay_change_s
                                                      : record.rig.cameras[k].time_offset_to_imu_s;
    result.first_from_camera = first.inverse() * result.calibration.body_from_camera;
    result.sigma_px = state.cameras[k].sigma_px;
    result.images = record.searched[k];
    setSigmas(state, posterior, k, has_imu, &result);
  }
  for (const FrameState& frame : state.frames) {
    for (const BoardView& view : frame.seen->views) {
      ++results[view.camera].views;
      const Quat camera_from_board =
          worldFromCamera(frame, state.cameras[view.camera]).rotation.conjugate() * state.worldFromBoard();
      tilts_rad[view.camera].push_back(
          std::acos(std::min(1.0, std::abs((camera_from_board * Vec3::UnitZ()).z()))));
    }
  }
  forEachError(record.board, state,
               [&](size_t, size_t camera, const BoardCorner& corner, const Vec2& error_px) {
                 results[camera].corners.push_back({corner.pixel, error_px});
               });
  for (size_t k = 0; k < results.size(); ++k) {
    setErrors(&results[k]);
    results[k].largest_tilt_rad = orderStatistic(std::move(tilts_rad[k]), 0.9);
  }
  return results;
}

double leastAcceleration(const RigState& state, std::span<const ImuSample> imu) {
  std::vector<Vec3> accelerations_W;
  Vec3 mean = Vec3::Zero();
  for (const FrameState& frame : state.frames) {
    const auto reading = readingAt(imu, state.timeOf(frame));
    if (!reading) continue;
    accelerations_W.push_back(poseFromBlock(frame.world_from_body.data()).rotation *
                                  reading->specific_force_B -
                              kStandardGravity * Vec3::UnitZ());
    mean += accelerations_W.back();
  }
  if (accelerations_W.empty()) return 0.0;
  const double count = static_cast<double>(accelerations_W.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& a : accelerations_W)
    covariance += (a - mean / count) * (a - mean / count).transpose() / count;
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvalues()[0]));
}

}  // namespace lodeline
