#include "lodeline/rig_calibration/problem/corner_factor.h"

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

enum Block { kPose, kMotion, kExtrinsics, kDelay, kTilt, kLens, kPort };

template <int kColumns>
using Rows2 = Eigen::Map<Eigen::Matrix<double, 2, kColumns, Eigen::RowMajor>>;

/// The way of a corner from the board to the camera.
struct CornerPath {
  Vec3 corner_W, from_body_W, corner_B, from_camera_B, corner_C;
  Mat3 body_from_world, camera_from_body;
  Vec3 rate_B, velocity_W, tilt;
  double delay_s;

  CornerPath(const Quat& level_from_board, const Vec3& reading_B, const Vec3& corner_T,
             double const* const* blocks) {
    const Rigid3 pose = poseFromBlock(blocks[kPose]), body_from_camera = poseFromBlock(blocks[kExtrinsics]);
    velocity_W = Vec3(blocks[kMotion]);
    rate_B = reading_B - Vec3(blocks[kMotion] + 3);
    delay_s = *blocks[kDelay];
    tilt = Vec3(blocks[kTilt][0], blocks[kTilt][1], 0.0);
    corner_W = so3::exp(tilt) * (level_from_board * corner_T);
    body_from_world = (pose.rotation * so3::exp(delay_s * rate_B)).toRotationMatrix().transpose();
    from_body_W = corner_W - pose.translation - delay_s * velocity_W;
    corner_B = body_from_world * from_body_W;
    from_camera_B = corner_B - body_from_camera.translation;
    camera_from_body = body_from_camera.rotation.toRotationMatrix().transpose();
    corner_C = camera_from_body * from_camera_B;
  }
};

void writeMotionPart(const CornerPath& path, const Mat23& by_corner_B, const Mat23& by_corner_W,
                     double** jacobians) {
  if (jacobians[kPose]) {
    Rows2<kPoseSize> block(jacobians[kPose]);
    block.leftCols<3>() = -by_corner_W;
    block.middleCols<3>(3) = by_corner_W * so3::skew(path.from_body_W);
    block.col(6).setZero();
  }
  if (jacobians[kMotion]) {
    Rows2<kMotionSize> block(jacobians[kMotion]);
    block.leftCols<3>() = -path.delay_s * by_corner_W;
    block.middleCols<3>(3) = -path.delay_s * by_corner_B * so3::skew(path.corner_B);
    block.rightCols<3>().setZero();
  }
  if (jacobians[kDelay]) {
    Eigen::Map<Vec2> column(jacobians[kDelay]);
    column = by_corner_B * path.corner_B.cross(path.rate_B) - by_corner_W * path.velocity_W;
  }
  if (jacobians[kTilt]) {
    const Mat3 by_tilt = -so3::skew(path.corner_W) * so3::leftJacobian(path.tilt);
    Rows2<2> block(jacobians[kTilt]);
    block = by_corner_W * by_tilt.leftCols<2>();
  }
}

}  // namespace

CornerFactor::CornerFactor(const RigState* rig, const CameraState* camera, const FrameState* frame,
                           const Vec3& corner_T, const Vec2& pixel)
    : rig_(rig), camera_(camera), frame_(frame), corner_T_(corner_T), pixel_(pixel) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {kPoseSize, kMotionSize, kPoseSize,
                                      1,         2,           static_cast<int>(camera->lens.size())};
  if (camera->base.port) mutable_parameter_block_sizes()->push_back(kPortSize);
}

bool CornerFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  if (!camera_->camera) return false;
  const CornerPath path(rig_->level_from_board, frame_->gyroscope_reading_B, corner_T_, parameters);
  const double per_sigma = 1.0 / camera_->sigma_px;
  Mat23 by_corner_C;
  PixelByParameters by_lens;
  const auto pixel = camera_->camera->project(path.corner_C, jacobians ? &by_corner_C : nullptr,
                                              jacobians && jacobians[kLens] ? &by_lens : nullptr);
  if (!pixel) return false;
  Eigen::Map<Vec2> error(residuals);
  error = per_sigma * (*pixel - pixel_);
  if (!jacobians) return true;
  const Mat23 by_corner_B = per_sigma * by_corner_C * path.camera_from_body;
  writeMotionPart(path, by_corner_B, by_corner_B * path.body_from_world, jacobians);
  if (jacobians[kExtrinsics]) {
    Rows2<kPoseSize> block(jacobians[kExtrinsics]);
    block.leftCols<3>() = -by_corner_B;
    block.middleCols<3>(3) = by_corner_B * so3::skew(path.from_camera_B);
    block.col(6).setZero();
  }
  if (jacobians[kLens])
    Eigen::Map<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>>(
        jacobians[kLens], 2, by_lens.cols()) = per_sigma * by_lens;
  if (camera_->base.port && jacobians[kPort]) {
    PixelByPort by_port;
    if (!camera_->behind_port->projectByPort(path.corner_C, &by_port)) return false;
    Rows2<kPortSize> block(jacobians[kPort]);
    block << per_sigma * by_port.leftCols<3>(), per_sigma * by_port.rightCols<1>();
  }
  return true;
}

}  // namespace lodeline
