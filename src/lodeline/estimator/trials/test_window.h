#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lodeline/estimator/trials/scene.h"
#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/problem/factor_builder.h"

namespace lodeline {

/// Test support: a window filled by hand, with frames at known states.
class TestWindow {
 public:
  /// Corrections of a camera's intrinsics (factors/intrinsics_factor.h).
  using Lens = std::array<double, kIntrinsicsSize>;

  explicit TestWindow(int cameras = 2, const EstimatorOptions& options = {});

  /// Adds a frame without inertial term; identities count up from 0.
  Frame& add(const Rigid3& world_from_body, bool is_keyframe = true);
  /// Adds a simulated frame at its true state, with its tracks and the inertial term to the frame before.
  Frame& add(const SimulatedFrame& frame, bool is_keyframe = true);

  /// Adds an observation of `point_W` from the frame's present pose, with a pixel error `error_px`. Fails the
  /// test where the camera cannot observe the point.
  void see(TrackId track, const Vec3& point_W, const Frame& frame, int camera = 0,
           const Vec2& error_px = Vec2::Zero());
  /// As see(), from the ray alone, for points that may lie outside the image or behind the camera.
  void seeAlong(TrackId track, const Vec3& bearing_C, const Frame& frame, int camera = 0);

  /// Adds the states of the camera calibration, with the intrinsics block `lens` for every camera.
  void calibrate(const Lens& lens);
  /// Adds an observation by a camera with such intrinsics. Fails the test where the camera cannot observe the
  /// point.
  void seeThrough(const Lens& lens, TrackId track, const Vec3& point_W, const Frame& frame, int camera);

  /// Creates a landmark at `point_W` with the host `host`, which must have observed the track with camera 0.
  Landmark& place(TrackId track, const Vec3& point_W, const Frame& host);
  Vec3 position(TrackId track) const;

  /// Fills the window with two seconds of a moving rig: ten frames, 40 tracks and their landmarks. Returns
  /// the prior of its first frame.
  Prior fill();

  /// Adds normal noise to all states: metres and radians with `sigma`, m/s with `sigma`, biases with a tenth.
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

/// The window's cost as one dense Gauss-Newton system, computed without NormalEquations. Rows: the frames'
/// blocks (pose 6, motion 9 where there is one) in the window's order, then the landmarks.
struct DenseSystem {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  std::vector<const double*> blocks;
  std::vector<int> offsets;
  int frame_rows = 0;

  int offsetOf(const double* block) const;
};
DenseSystem denseSystem(Window& window, const Prior& prior, const FactorBuilder& factors);

/// Schur complement h_kk - h_kg h_gg^-1 h_gk on the first `kept` rows, and the corresponding gradient.
struct Reduced {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
};
Reduced denseSchur(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient, int kept);

}  // namespace lodeline
