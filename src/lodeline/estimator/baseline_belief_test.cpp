#include "lodeline/estimator/baseline_belief.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/estimator/camera_states.h"
#include "lodeline/estimator/estimator.h"
#include "lodeline/estimator/test_scene.h"
#include "lodeline/simulation/imu_model.h"
#include "lodeline/simulation/point_dive.h"
#include "lodeline/simulation/point_simulation.h"

namespace lodeline {
namespace {

constexpr double kBaseline_m = 0.14, kStated_m = 3e-4;

TEST(OddsForBaseline, AreThoseOfTheSharesWhereNothingIsSeen) {
  // Known to a few centimetres, a length is as likely of one kind as of the other, but for how many there
  // are.
  EXPECT_NEAR(oddsForBaseline({0.0, 0.011}, kStated_m, kBaseline_m), std::log(9.0), 0.1);
}

TEST(OddsForBaseline, GrowAsLongAsTheLengthStaysTheStatedOne) {
  double before = oddsForBaseline({0.0, 0.01}, kStated_m, kBaseline_m);
  for (const double sigma_m : {5e-3, 2e-3, 5e-4, 1e-5}) {
    const double odds = oddsForBaseline({0.0, sigma_m}, kStated_m, kBaseline_m);
    EXPECT_GT(odds, before);
    before = odds;
  }
  EXPECT_LT(before, std::log(9.0 * 0.2 * kBaseline_m / (std::sqrt(2.0 * M_PI) * kStated_m)) + 1e-3)
      << "no file is right to less than it states";
}

TEST(OddsForBaseline, TurnAgainstAFileByFourSigmas) {
  EXPECT_GT(oddsForBaseline({2e-3, 1e-3}, kStated_m, kBaseline_m), 0.0);
  EXPECT_LT(oddsForBaseline({-4e-3, 1e-3}, kStated_m, kBaseline_m), 0.0);
  EXPECT_EQ(oddsForBaseline({-5e-3, 1e-3}, kStated_m, kBaseline_m),
            oddsForBaseline({5e-3, 1e-3}, kStated_m, kBaseline_m));
}

/// A stereo dive of points at 0.25 m/s, of which the first `seconds` are seen, with a file whose baseline is
/// `error_m` too long; calls `observe` with the corrections after every frame that has some.
template <typename Observe>
void dive(uint64_t seed, double seconds, double error_m, const Observe& observe) {
  const ImuErrors imu = drawImuErrors(imuGrade("gx5-25"), SpecimenOptions(), seed);
  DiveMotionOptions motion;
  motion.seed = seed;
  motion.duration_s = 120.0;
  motion.path_length_m = 30.0;
  const PointDive dive = makePointDive(motion, standardRig(StandardRigOptions()), imu);
  PointSimulationOptions points;
  points.seed = seed;
  points.frame_rate_hz = 10.0;
  points.tracks = 80;
  points.pixel_sigma_px = 0.2;
  points.imu = imu;
  PointSimulation simulation = dive.simulate(points);
  Rig rig = dive.mounted.rig;
  const Rigid3 first = rig.cameras[0].body_from_camera;
  Rigid3 first_from_second = first.inverse() * rig.cameras[1].body_from_camera;
  first_from_second.translation += error_m * first_from_second.translation.normalized();
  rig.cameras[1].body_from_camera = first * first_from_second;
  Diagnostics diagnostics;
  EstimatorOptions options = honestOptions(TestSceneOptions());
  options.preintegration = PreintegrationOptions();
  options.initial_state = InitialStateOptions();
  options.imu_axes = ImuAxesOptions();
  options.camera_calibration = CameraCalibrationOptions();
  Estimator estimator(rig, options, &diagnostics);
  for (int k = 0; k < static_cast<int>(10.0 * seconds); ++k) {
    const auto frame = simulation.next();
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
    if (estimate.camera_corrections) observe(*estimate.camera_corrections);
  }
}

// With a Cauchy loss in place of the belief the accelerometer's noise drew this baseline 1 mm away after 25
// s, and the scale by 0.7 %.
TEST(BaselineBelief, KeepsARightFileFromTheNoiseOfTheAccelerometer) {
  double farthest_m = 0.0;
  dive(10, 30.0, 0.0, [&](const CameraCorrections& seen) {
    farthest_m = std::max(farthest_m, seen.extrinsics[1].tail<3>().norm());
    EXPECT_LE(seen.place_sigmas_m[0], 3e-4);
  });
  EXPECT_LT(farthest_m, 4e-4);
}

TEST(BaselineBelief, LetsGoOfAFileThatIsCentimetresOff) {
  CameraCorrections last;
  dive(2, 40.0, 0.02, [&](const CameraCorrections& seen) { last = seen; });
  EXPECT_EQ(last.place_sigmas_m[0], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(last.extrinsics[1].tail<3>().norm(), 0.02, 0.003);
}

}  // namespace
}  // namespace lodeline
