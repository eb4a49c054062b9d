#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lodeline/estimator/trials/heading_trial.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/shared/random.h"

// Tests of a north that is found after the first pose, or replaced.

namespace lodeline {
namespace {

const Vec3 kField_W(4e-6, 24e-6, -38e-6);

HeadingTrialOptions trialOptions(double duration_s) {
  HeadingTrialOptions options;
  options.duration_s = duration_s;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  return options;
}

// Heading error of a finished run relative to north, degrees, over the last half of the dive.
double lastHalf_deg(const HeadingTrial& trial, const HeadingTrialOptions& options) {
  EXPECT_NE(trial.reference, HeadingReference::Start);
  return trial.finishedRms(0.5 * options.duration_s) / kDegree;
}

TEST(MagnetometerNorth, FindsNorthHoweverLateItIsHeard) {
  for (const int cameras : {2, 1}) {
    HeadingTrialOptions options = trialOptions(140.0);
    options.cameras = cameras;
    if (cameras == 1) options.frame_rate_hz = 10.0;
    if (cameras == 1) options.tracks = 80;
    const HeadingTrial in_time = runHeadingTrial(options);
    // With one camera the initialization takes some seconds, so readings from 1 s on are in time.
    for (const double from_s : cameras == 1 ? std::vector{10.0, 60.0} : std::vector{0.2, 1.0, 10.0, 60.0}) {
      options.magnetometer_from_s = from_s;
      const HeadingTrial late = runHeadingTrial(options);
      ASSERT_EQ(late.samples.size(), in_time.samples.size());
      double largest_rad = 0.0;
      for (size_t i = late.samples.size() / 2; i < late.samples.size(); ++i) {
        largest_rad = std::max(largest_rad, std::abs(late.samples[i].finished_error_rad -
                                                     in_time.samples[i].finished_error_rad));
      }
      EXPECT_LT(largest_rad, 0.3 * kDegree) << cameras << " " << from_s;
      EXPECT_LT(lastHalf_deg(late, options), 0.5) << cameras << " " << from_s;
      // From the first pose on, including the gyroscope's drift before north was found.
      EXPECT_LT(late.finishedRms(0.0), 1.0 * kDegree) << cameras << " " << from_s;
      EXPECT_LT(late.rms(from_s + 20.0), 2.0 * late.claimed(from_s + 20.0)) << cameras << " " << from_s;
      EXPECT_LT(late.claimed(from_s + 20.0), 1.0 * kDegree) << cameras << " " << from_s;
    }
  }
}

TEST(MagnetometerNorth, KeepsNorthOverAPause) {
  HeadingTrialOptions options = trialOptions(140.0);
  const HeadingTrial in_time = runHeadingTrial(options);
  options.magnetometer_from_s = 5.0;
  options.magnetometer_pause = MotionInterval{20.0, 80.0};
  const HeadingTrial paused = runHeadingTrial(options);
  EXPECT_LT(std::abs(lastHalf_deg(paused, options) - lastHalf_deg(in_time, options)), 0.3);
  EXPECT_LT(paused.largest(10.0), 1.0 * kDegree);
}

TEST(MagnetometerNorth, IsNotFixedToTheFieldOfABoatThatItStartsBeside) {
  for (const bool knows_site : {false, true}) {
    HeadingTrialOptions options = trialOptions(140.0);
    if (knows_site) options.estimator.magnetometer.site_field_W = Vec3(0.0, 24.2e-6, -38.6e-6);
    const HeadingTrial clean = runHeadingTrial(options);
    for (const double from_s : {0.0, 10.0}) {
      options.trouble = FieldTrouble::Boat;
      options.magnetometer_from_s = from_s;
      const HeadingTrial boat = runHeadingTrial(options);
      EXPECT_LT(std::abs(lastHalf_deg(boat, options) - lastHalf_deg(clean, options)), 0.3)
          << knows_site << from_s;
      EXPECT_LT(boat.finishedRms(0.0), 5.0 * kDegree) << "the start is turned as the rest is";
      EXPECT_GT(boat.share(MagnetometerStatus::Used), 0.5) << knows_site << from_s;
    }
  }
}

// Heading error in reported sigmas at the end of a scene that begins with 8 s of rest, with an unknown
// accelerometer bias.
double headingErrorAfterRest_sigmas(uint64_t seed, int* used) {
  TestSceneOptions scene_options;
  scene_options.duration_s = 16.0;
  scene_options.points.tracks = 40;
  scene_options.points.frame_rate_hz = 5.0;
  scene_options.seed = seed;
  scene_options.accelerometer_bias_sigma_m_per_s2 = 0.2;
  scene_options.still = {{-10.0, 18.0}};
  TestScene scene(scene_options);
  Rig rig = scene.rig();
  rig.magnetometer = MagnetometerCalibration();
  rig.magnetometer->is_calibrated = true;
  rig.magnetometer->hard_iron_sigma_T = 0.01e-6;
  Diagnostics diagnostics;
  Estimator estimator(rig, honestOptions(scene_options), &diagnostics);
  Random random(seed, "noise of the field");
  const Vec3 hard_iron_B = MagnetometerOptions().offset_sigma_T * random.normal3();
  const double north = std::atan2(kField_W.x(), kField_W.y());  // from y towards x
  double sigmas = 0.0;
  while (const auto frame = scene.next()) {
    const Quat& rotation = frame->truth.motion.world_from_body.rotation;
    const MagnetometerSample reading{
        frame->truth.time, rotation.conjugate() * kField_W + hard_iron_B + 0.02e-6 * random.normal3()};
    const FrameEstimate estimate =
        estimator.add(frame->tracks, frame->imu, SensorReadings(std::vector{reading}));
    *used += estimate.sensors.of<MagnetometerEstimate>().status == MagnetometerStatus::Used;
    const Quat magnetic_from_true = so3::exp(north * Vec3::UnitZ());
    const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
    const Quat magnetic_from_world =
        so3::exp(magnetometer.north_from_world_rad.value_or(0.0) * Vec3::UnitZ());
    sigmas = headingBetween(magnetic_from_true * rotation,
                            magnetic_from_world * estimate.state.world_from_body.rotation) /
             magnetometer.heading_sigma_rad;
  }
  return sigmas;
}

// An accelerometer bias of 0.2 m/s^2 tilts an initialization at rest by more than a degree, and the north
// found then by two.
TEST(MagnetometerNorth, RightsANorthThatWasTakenAslant) {
  constexpr int kScenes = 12;
  double squares = 0.0;
  int used = 0;
  for (uint64_t seed = 1; seed <= kScenes; ++seed)
    squares += std::pow(headingErrorAfterRest_sigmas(seed, &used), 2);
  EXPECT_LT(squares / kScenes, 2.0) << "errors are larger than claimed";
  EXPECT_GT(squares / kScenes, 0.2);
  EXPECT_GT(used, 0.95 * kScenes * 16.0 * 5.0);
}

}  // namespace
}  // namespace lodeline
