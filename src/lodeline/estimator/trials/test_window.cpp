#include "lodeline/estimator/trials/test_window.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {

TestWindow::TestWindow(int cameras, const EstimatorOptions& options_in)
    : rig(testRig(cameras)), options(options_in), factors(rig, options) {
  for (const CameraCalibration& camera : rig.cameras) cameras_.push_back(makeCamera(camera));
}

Frame& TestWindow::add(const Rigid3& world_from_body, bool is_keyframe) {
  auto frame = std::make_unique<Frame>();
  frame->id = next_id_++;
  frame->is_keyframe = is_keyframe;
  NavigationState state;
  state.time = Time::fromSeconds(0.1 * static_cast<double>(frame->id));
  state.world_from_body = world_from_body;
  frame->setState(state);
  return window.add(std::move(frame));
}

Frame& TestWindow::add(const SimulatedFrame& simulated, bool is_keyframe) {
  const TrueState& truth = simulated.truth;
  const Frame* before = window.empty() ? nullptr : &window.newest();
  Frame& frame = add(truth.motion.world_from_body, is_keyframe);
  frame.setState({truth.time, truth.motion.world_from_body, truth.motion.velocity_W, truth.gyroscope_bias_B,
                  truth.accelerometer_bias_B});
  if (before) {
    frame.from_previous = std::make_unique<Preintegration>(
        simulated.imu, before->gyroscopeBias(), before->accelerometerBias(), rig.imu, options.preintegration);
  }
  for (const FeatureObservation& o : simulated.tracks.observations) {
    if (o.camera < static_cast<int>(cameras_.size()))
      addObservation(o.track, o.bearing_C, frame, o.camera, o.sigma_px);
  }
  return frame;
}

Prior TestWindow::fill() {
  TestSceneOptions scene_options;
  scene_options.cameras = static_cast<int>(cameras_.size());
  scene_options.duration_s = 2.0;
  scene_options.points.tracks = 40;
  scene_options.points.frame_rate_hz = 5.0;
  TestScene scene(scene_options);
  while (const auto frame = scene.next()) add(*frame);
  createLandmarks(window, factors, options.landmark);
  return startPrior(*window.frames().front(), options.initial_state, 0.05);
}

void TestWindow::addObservation(TrackId track, const Vec3& bearing_C, const Frame& frame, int camera,
                                double sigma_px) {
  const DirectionMeasurement measurement =
      DirectionMeasurement::fromBearing(*cameras_[camera], bearing_C, sigma_px);
  window.addObservation(track, {frame.id, camera, measurement});
}

Vec3 TestWindow::pointInCamera(const Vec3& point_W, const Frame& frame, int camera) const {
  return (frame.worldFromBody() * rig.cameras[camera].body_from_camera).inverse() * point_W;
}

void TestWindow::see(TrackId track, const Vec3& point_W, const Frame& frame, int camera,
                     const Vec2& error_px) {
  const std::optional<Vec2> pixel = cameras_[camera]->project(pointInCamera(point_W, frame, camera));
  ASSERT_TRUE(pixel && cameras_[camera]->contains(*pixel)) << "track " << track << " is out of view";
  addObservation(track, *cameras_[camera]->unproject(*pixel + error_px), frame, camera, 1.0);
}

void TestWindow::seeAlong(TrackId track, const Vec3& bearing_C, const Frame& frame, int camera) {
  addObservation(track, bearing_C.normalized(), frame, camera, 1.0);
}

void TestWindow::calibrate(const Lens& lens) {
  const int cameras = static_cast<int>(cameras_.size());
  Prior prior;
  addCameraStates(window, prior, cameras, options.camera_calibration);
  addIntrinsicsStates(window, prior, cameras, options.camera_calibration);
  for (ParameterBlock* state : cameraStates(window).intrinsics) state->value.assign(lens.begin(), lens.end());
}

void TestWindow::seeThrough(const Lens& lens, TrackId track, const Vec3& point_W, const Frame& frame,
                            int camera) {
  const auto through = makeCamera(correctedIntrinsics(rig.cameras[camera], lens.data()));
  const std::optional<Vec2> pixel = through->project(pointInCamera(point_W, frame, camera));
  ASSERT_TRUE(pixel && cameras_[camera]->contains(*pixel)) << "track " << track << " is out of view";
  addObservation(track, *cameras_[camera]->unproject(*pixel), frame, camera, 1.0);
}

Landmark& TestWindow::place(TrackId track, const Vec3& point_W, const Frame& host) {
  FeatureTrack& history = window.tracks().at(track);
  Landmark landmark;
  landmark.host = host.id;
  landmark.base = LandmarkBase(history.find(host.id, 0)->measurement.bearing_C);
  const Vec3 point_C = pointInCamera(point_W, host, 0);
  const double depth = landmark.base.bearing_C.dot(point_C);
  const Vec2 ab = landmark.base.tangent_C.transpose() * point_C / depth;
  landmark.parameters = {ab.x(), ab.y(), 1.0 / depth};
  history.landmark = landmark;
  return *history.landmark;
}

Vec3 TestWindow::position(TrackId track) const {
  const Landmark& landmark = *window.tracks().at(track).landmark;
  const Rigid3 world_from_camera =
      window.find(landmark.host)->worldFromBody() * rig.cameras[0].body_from_camera;
  return world_from_camera *
         Vec3(landmark.base.direction(landmark.parameters.data()) / landmark.parameters[2]);
}

void TestWindow::disturb(double sigma, uint64_t seed) {
  Random random(seed, "disturb");
  for (const auto& frame : window.frames()) {
    Eigen::Matrix<double, 6, 1> step;
    step << sigma * random.normal3(), sigma * random.normal3();
    poseToBlock(perturbed(frame->worldFromBody(), step), frame->pose.data());
    for (int i = 0; i < kMotionSize; ++i) frame->motion[i] += (i < 3 ? 1.0 : 0.1) * sigma * random.normal();
  }
}

int DenseSystem::offsetOf(const double* block) const {
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i] == block) return offsets[i];
  }
  ADD_FAILURE() << "no such block";
  return 0;
}

namespace {

void addDense(const Factor& factor, DenseSystem* system) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int rows = factor.function->num_residuals();
  const std::vector<int>& sizes = factor.function->parameter_block_sizes();
  std::vector<RowMajor> parts;
  std::vector<double*> pointers;
  for (const int size : sizes) parts.emplace_back(rows, size);
  for (RowMajor& part : parts) pointers.push_back(part.data());
  Eigen::VectorXd residual(rows);
  ASSERT_TRUE(factor.function->Evaluate(factor.blocks.data(), residual.data(), pointers.data()));
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows, system->hessian.cols());
  for (size_t b = 0; b < parts.size(); ++b) {
    const int tangent = sizes[b] == kPoseSize ? kPoseTangentSize : sizes[b];
    jacobian.middleCols(system->offsetOf(factor.blocks[b]), tangent) += parts[b].leftCols(tangent);
  }
  double weight = 1.0;
  if (factor.loss) {
    double rho[3];
    factor.loss->Evaluate(residual.squaredNorm(), rho);
    weight = rho[1];
  }
  system->hessian += weight * jacobian.transpose() * jacobian;
  system->gradient += weight * jacobian.transpose() * residual;
}

}  // namespace

DenseSystem denseSystem(Window& window, const Prior& prior, const FactorBuilder& factors) {
  DenseSystem system;
  int rows = 0;
  const auto append = [&](const double* block, int tangent) {
    system.blocks.push_back(block);
    system.offsets.push_back(rows);
    rows += tangent;
  };
  for (const auto& frame : window.frames()) {
    append(frame->pose.data(), kPoseTangentSize);
    if (frame->has_motion) append(frame->motion.data(), kMotionSize);
  }
  system.frame_rows = rows;
  for (auto& [id, track] : window.tracks()) {
    if (track.landmark) append(track.landmark->parameters.data(), kLandmarkSize);
  }
  system.hessian = Eigen::MatrixXd::Zero(rows, rows);
  system.gradient = Eigen::VectorXd::Zero(rows);

  if (!prior.empty()) addDense(factors.prior(prior), &system);
  Frame* before = nullptr;
  for (const auto& frame : window.frames()) {
    if (before && frame->from_previous) addDense(factors.inertial(window, *before, *frame), &system);
    before = frame.get();
  }
  for (auto& [id, track] : window.tracks()) {
    if (!track.landmark) continue;
    for (const Factor& factor : factors.landmark(window, track).factors) addDense(factor, &system);
  }
  return system;
}

Reduced denseSchur(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient, int kept) {
  const int gone = static_cast<int>(hessian.rows()) - kept;
  const Eigen::MatrixXd solved =
      hessian.bottomRightCorner(gone, gone).fullPivLu().solve(hessian.bottomLeftCorner(gone, kept));
  return {hessian.topLeftCorner(kept, kept) - hessian.topRightCorner(kept, gone) * solved,
          gradient.head(kept) - solved.transpose() * gradient.tail(gone)};
}

}  // namespace lodeline
