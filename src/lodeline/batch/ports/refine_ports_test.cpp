// Ports as states of the batch solution.

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/batch/ports/test_port_dive.h"

namespace lodeline {
namespace {

EstimatorOptions heldPorts() {
  EstimatorOptions options;
  options.camera_calibration.port_normal_sigma_rad = options.camera_calibration.port_distance_sigma_m = 0.0;
  return options;
}

class RefinePorts : public testing::TestWithParam<std::tuple<int, Port::Type>> {
 protected:
  static PortDiveOptions dive() {
    PortDiveOptions options;
    options.cameras = std::get<0>(GetParam());
    options.type = std::get<1>(GetParam());
    return options;
  }
  static double priorSigma(int axis) {
    const CameraCalibrationOptions options;
    const bool is_turn = std::get<1>(GetParam()) == Port::Type::Flat && axis < 2;
    return is_turn ? options.port_normal_sigma_rad : options.port_distance_sigma_m;
  }
};
INSTANTIATE_TEST_SUITE_P(Rigs, RefinePorts,
                         testing::Combine(testing::Values(1, 2),
                                          testing::Values(Port::Type::Flat, Port::Type::Dome)));

TEST_P(RefinePorts, FindsThePortWithinItsClaims) {
  const PortDive run(dive(), {});
  const Refinement refined = refine(run.given, run.options, run.record);
  ASSERT_TRUE(refined.summary.usable()) << refined.summary.refusal;
  ASSERT_TRUE(refined.summary.camera_corrections);
  const std::vector<PortCorrection>& ports = refined.summary.camera_corrections->ports;
  ASSERT_EQ(ports.size(), run.true_changes.size());
  const bool is_flat = std::get<1>(GetParam()) == Port::Type::Flat;
  for (size_t i = 0; i < ports.size(); ++i) {
    const Vec3 left = ports[i].change - run.true_changes[i];
    EXPECT_EQ(ports[i].is_dome, !is_flat);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(ports[i].sigma[axis], 0.0);
      EXPECT_LT(std::abs(left[axis]), 3.0 * ports[i].sigma[axis]) << "camera " << i << ", axis " << axis;
      EXPECT_LT(ports[i].sigma[axis], 1.0001 * priorSigma(axis));
    }
    double before = 0.0, after = 0.0;  // in units of the prior
    for (int axis = 0; axis < 3; ++axis) {
      before += std::pow(run.true_changes[i][axis] / priorSigma(axis), 2);
      after += std::pow(left[axis] / priorSigma(axis), 2);
    }
    EXPECT_LT(after, before) << "camera " << i;
  }
  const Refinement held = refine(run.given, heldPorts(), run.record);
  ASSERT_TRUE(held.summary.usable());
  EXPECT_FALSE(held.summary.camera_corrections);
  EXPECT_LT(run.rms(refined.frames), 1.02 * run.rms(held.frames));
}

TEST(RefinePort, KeepsWhatTheFileStatesRightly) {
  PortDiveOptions dive;
  dive.normal_error_rad = dive.length_error_m = 0.0;
  const PortDive run(dive, {});
  const Refinement refined = refine(run.given, run.options, run.record);
  ASSERT_TRUE(refined.summary.camera_corrections);
  for (const PortCorrection& port : refined.summary.camera_corrections->ports) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_LT(std::abs(port.change[axis]), 3.0 * port.sigma[axis]);
  }
}

TEST(RefinePort, IsHeldWithTheLens) {
  PortDiveOptions dive;
  dive.seconds = 40.0;
  dive.metres = 8.0;
  EstimatorOptions options;
  options.camera_calibration.intrinsics = false;
  const PortDive run(dive, options);
  EXPECT_FALSE(refine(run.given, run.options, run.record).summary.camera_corrections);
}

}  // namespace
}  // namespace lodeline
