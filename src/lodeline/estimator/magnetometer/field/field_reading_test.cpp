#include "lodeline/estimator/magnetometer/field/field_reading.h"

#include <gtest/gtest.h>

#include <optional>

#include "lodeline/estimator/trials/heading_trial.h"

namespace lodeline {
namespace {

// A diver swims away from a boat, whose field was taken for the Earth's. The gate then rejects the Earth's
// field for a while, and the frames know it all the same.
TEST(FieldReading, IsTheFieldOfFramesThatTheGateRejects) {
  HeadingTrialOptions options;
  options.duration_s = 60.0;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.trouble = FieldTrouble::Boat;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  std::optional<Time> first;
  int frames = 0, rejected = 0;
  runTrialDive(options,
               [&](const SimulatedFrame&, const FrameEstimate& estimate, const Estimator& estimator) {
                 if (!estimator.initialized()) return;
                 if (!first) first = estimate.state.time;
                 if ((estimate.state.time - *first).seconds() < 42.0) return;
                 const auto* reading = estimator.window().newest().measurements.find<FieldReading>();
                 ASSERT_NE(reading, nullptr);
                 EXPECT_NEAR(reading->field_B.norm(), HeadingTrialOptions::field_W().norm(), 1e-6);
                 EXPECT_GT(reading->sigma_T, 0.0);
                 ++frames;
                 rejected += estimate.sensors.of<MagnetometerEstimate>().status != MagnetometerStatus::Used;
               });
  EXPECT_GT(frames, 60);
  EXPECT_GT(rejected, 0);
}

}  // namespace
}  // namespace lodeline
