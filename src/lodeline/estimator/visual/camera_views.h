#pragma once

#include <vector>

#include "lodeline/problem/factor_builder.h"

namespace lodeline {

/// Poses of the cameras of every frame of a window, computed once for all observations that need them. They
/// are taken at the blocks' present values or at their linearization points (factors/parameters.h).
class CameraViews {
 public:
  enum class At { kValues, kLinearizationPoints };

  /// Pose of camera 0 of one frame at the true time of its images. Its perturbation is [dp, dtheta] in world
  /// axes, like that of a body.
  struct Placement {
    Mat3 world_from_camera;  ///< rotation
    Vec3 position_W;
    Mat6 by_body;  ///< d(pose) / d(pose of the body)
    Eigen::Matrix<double, 6, 7>
        by_calibration;  ///< d(pose) / d[phi, xi, dt], see calibrated_reprojection_factor.h
  };

  /// Pose of a secondary camera, in axes of camera 0.
  struct Further {
    Mat3 camera0_from_camera;
    Vec3 position_C0;
    Mat3 left_jacobian;  ///< of phi
  };

  /// Pose of a host's camera 0 in a target camera: the homogeneous point is q = rotation d + rho translation.
  struct Relative {
    Mat3 rotation;
    Vec3 translation;
  };

  /// All three must outlive the views. `hosts`: frames that are hosts of landmarks. The poses are undefined
  /// before the first update().
  CameraViews(const Window& window, const CameraStates& states, const FactorBuilder& factors, At at,
              std::vector<int> hosts);

  /// Computes all poses anew, after a block has changed.
  void update();

  /// Frames count from the oldest of the window.
  const Placement& placement(int frame) const { return placements_[static_cast<size_t>(frame)]; }
  const Further& secondary(int camera) const { return secondary_[static_cast<size_t>(camera) - 1]; }
  const std::vector<int>& hosts() const { return hosts_; }
  /// For hosts in hosts() only.
  const Relative& relative(int host, int target, int camera) const {
    return relative_[static_cast<size_t>((host * frames_ + target) * cameras_ + camera)];
  }

 private:
  Placement placeFrame(const Frame& frame) const;
  Further placeFurther(int camera) const;
  void relate(int host, int target);
  const double* valueOf(const ParameterBlock& state) const;

  const Window& window_;
  const CameraStates& states_;
  const FactorBuilder& factors_;
  At at_;
  int frames_;
  int cameras_;
  std::vector<int> hosts_;
  std::vector<Placement> placements_;
  std::vector<Further> secondary_;
  std::vector<Relative> relative_;  // by host, target, camera
};

}  // namespace lodeline
