#pragma once

#include <memory>
#include <vector>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/trials/scene.h"

namespace lodeline {

/// For tests: a window filled by hand, with frames at known states.
class TestWindow {
 public:
  explicit TestWindow(int cameras = 2, const EstimatorOptions& options = {});

  /// A frame without inertial term; identities count up from 0.
  Frame& add(const Rigid3& world_from_body, bool is_keyframe = true);
  /// A simulated frame at its true state, with its tracks and the inertial term to the frame before.
  Frame& add(const SimulatedFrame& frame, bool is_keyframe = true);

  /// An observation of `point_W` from where the frame stands now, off by `error_px`. Fails the test where the
  /// camera cannot see it.
  void see(TrackId track, const Vec3& point_W, const Frame& frame, int camera = 0,
           const Vec2& error_px = Vec2::Zero());
  /// As see(), for points that may lie outside the image or behind the camera: from the ray alone.
  void seeAlong(TrackId track, const Vec3& bearing_C, const Frame& frame, int camera = 0);

  /// Adds the states of the camera calibration, with `lens` (factors/intrinsics_factor.h) for every camera.
  void calibrate(const std::vector<double>& lens);
  /// An observation through such a lens. Fails the test where the camera cannot see the point.
  void seeThrough(const std::vector<double>& lens, TrackId track, const Vec3& point_W, const Frame& frame,
                  int camera);

  /// A landmark at `point_W`, hosted in `host`, which must have seen the track with camera 0.
  Landmark& place(TrackId track, const Vec3& point_W, const Frame& host);
  Vec3 position(TrackId track) const;

  /// Fills it with two seconds of a moving rig: ten frames, 40 tracks and their landmarks. Returns the prior
  /// of its first frame.
  Prior fill();

  /// Moves all states by normal noise: metres and radians by `sigma`, m/s by `sigma`, biases by a tenth.
  void disturb(double sigma, uint64_t seed);

  Rig rig;
  EstimatorOptions options;
  FactorBuilder factors;
  Window window;

 private:
  Vec3 pointInCamera(const Vec3& point_W, const Frame& frame, int camera) const;
  void addObservation(TrackId track, const Vec3& bearing_C, const Frame& frame, int camera, double sigma_px);

  std::vector<std::shared_ptr<const Camera>> cameras_;
  FrameId next_id_ = 0;
};

/// The window's cost as one dense Gauss-Newton system, put together without NormalEquations: rows of the
/// frames' blocks (pose 6, motion 9 where there is one) in the window's order, then those of the landmarks.
struct DenseSystem {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  std::vector<const double*> blocks;
  std::vector<int> offsets;
  int frame_rows = 0;

  int offsetOf(const double* block) const;
};
DenseSystem denseSystem(Window& window, const Prior& prior, const FactorBuilder& factors);

/// h_kk - h_kg h_gg^-1 h_gk over the first `kept` rows, and the gradient with it.
struct Reduced {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};
Reduced denseSchur(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient, int kept);

}  // namespace lodeline
