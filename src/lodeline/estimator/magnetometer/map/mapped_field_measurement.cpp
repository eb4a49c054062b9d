#include "lodeline/estimator/magnetometer/map/mapped_field_measurement.h"

#include "lodeline/factors/sensors/magnetometer_map_factor.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

std::vector<Factor> MappedFieldMeasurement::factors(const MeasurementContext& context) const {
  std::vector<Factor> factors;
  ParameterBlock* heading = context.window.findGlobal(kHeading);
  if (heading == nullptr) return factors;
  Frame& frame = context.frame;
  const double* first_pose = frame.firstPose();
  const Quat reference = poseFromBlock(first_pose ? first_pose : frame.pose.data()).rotation;
  Factor factor;
  factor.function = std::make_unique<MagnetometerMapFactor>(reading_B, mapped_M, covariance_W, reference,
                                                            first_pose, heading->linearizationPoint());
  factor.blocks = {frame.pose.data(), heading->value.data()};
  factors.push_back(std::move(factor));
  return factors;
}

void MappedFieldMeasurement::fixLinearizationPoints(const Window& window) const {
  if (ParameterBlock* heading = window.findGlobal(kHeading); heading && !heading->first)
    heading->first = heading->value;
}

std::shared_ptr<const Measurement> MappedFieldMeasurement::weighted(int count) const {
  auto weighted = std::make_shared<MappedFieldMeasurement>(*this);
  weighted->covariance_W /= static_cast<double>(count);
  return weighted;
}

}  // namespace lodeline
