// Ports as states of the batch solution.

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/batch/test_port_dive.h"

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
      const double prior = is_flat && axis < 2 ? run.options.camera_calibration.port_normal_sigma_rad
                                               : run.options.camera_calibration.port_distance_sigma_m;
      EXPECT_LT(ports[i].sigma[axis], 1.0001 * prior);
    }
    std::printf("camera %zu: true %g %g %g, found %g %g %g, sigma %g %g %g\n", i, run.true_changes[i].x(),
                run.true_changes[i].y(), run.true_changes[i].z(), ports[i].change.x(), ports[i].change.y(),
                ports[i].change.z(), ports[i].sigma.x(), ports[i].sigma.y(), ports[i].sigma.z());
  }
  const PortDive same(dive(), heldPorts());
  const Refinement held = refine(same.given, same.options, same.record);
  std::printf("position: run %g held %g free %g; heading run %g held %g free %g; %g s %g s\n",
              run.rms(run.record.frames()), run.rms(held.frames), run.rms(refined.frames),
              run.rms(run.record.frames(), true), run.rms(held.frames, true), run.rms(refined.frames, true),
              held.summary.processor_s, refined.summary.processor_s);
}

}  // namespace
}  // namespace lodeline
