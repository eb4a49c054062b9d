#include "lodeline/estimator/pressure/depth_measurement.h"

#include <cmath>

#include "lodeline/estimator/pressure/depth_states.h"

namespace lodeline {

std::vector<Factor> DepthMeasurement::factors(const MeasurementContext& context) const {
  const DepthStates states(context.window);
  std::vector<Factor> factors;
  if (!states) return factors;
  Factor& factor = factors.emplace_back();
  factor.function = std::make_unique<DepthFactor>(depth, port_B, sigma_m, context.frame.firstPose(),
                                                  states.scale->linearizationPoint());
  factor.blocks = {context.frame.pose.data(), states.offset->value.data(), states.scale->value.data(),
                   states.lag->value.data()};
  return factors;
}

std::shared_ptr<const Measurement> DepthMeasurement::weighted(int count) const {
  auto weighted = std::make_shared<DepthMeasurement>(*this);
  weighted->sigma_m /= std::sqrt(static_cast<double>(count));
  return weighted;
}

}  // namespace lodeline
