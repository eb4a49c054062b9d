#include "lodeline/estimator/magnetometer/field/field_measurement.h"

#include <cmath>
#include <optional>
#include <utility>

#include "lodeline/estimator/magnetometer/currents/current_states.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/factors/sensors/magnetometer_relative_factor.h"

namespace lodeline {
namespace {

Factor relativeFactor(const FieldMeasurement& measured, Frame& before, Frame& frame) {
  const Quat gamma =
      frame.from_previous->correctedFor(before.gyroscopeBias(), before.accelerometerBias()).gamma;
  Factor factor;
  factor.function = std::make_unique<MagnetometerRelativeFactor>(
      measured.mean.newest_B, gamma * measured.mean.field_B, measured.mean.readings, measured.noise.sigma_T,
      before.firstPose(), frame.firstPose());
  factor.blocks = {before.pose.data(), frame.pose.data()};
  return factor;
}

/// Nothing where the window lacks the fields of the measurement's currents.
std::optional<Factor> fieldFactor(const FieldMeasurement& measured, const Window& window,
                                  const MagnetometerStates& states, Frame& frame) {
  const double* first_pose = frame.firstPose();
  const Quat reference = poseFromBlock(first_pose ? first_pose : frame.pose.data()).rotation;
  const Vec3 field_W = states.field_W() + (measured.disturbed ? states.disturbance_W() : Vec3::Zero());
  const CurrentStates currents(window, measured.currents_A.size());
  if (currents.blocks.size() != measured.currents_A.size()) return {};
  Factor factor;
  factor.function = std::make_unique<MagnetometerFieldFactor>(
      measured.mean.field_B, measured.mean.carried, reference, field_W, measured.noise, measured.disturbed,
      first_pose, states.field->linearizationPoint(), measured.currents_A);
  factor.blocks = {frame.pose.data(), states.field->value.data(), states.offset->value.data()};
  if (measured.disturbed) factor.blocks.push_back(states.disturbance->value.data());
  for (ParameterBlock* block : currents.blocks) factor.blocks.push_back(block->value.data());
  return factor;
}

}  // namespace

std::vector<Factor> FieldMeasurement::factors(const MeasurementContext& context) const {
  std::vector<Factor> factors;
  if (relative) {
    if (context.before && context.frame.from_previous)
      factors.push_back(relativeFactor(*this, *context.before, context.frame));
    return factors;
  }
  const MagnetometerStates states(context.window);
  if (!states.field || !states.offset) return factors;
  if (auto factor = fieldFactor(*this, context.window, states, context.frame))
    factors.push_back(std::move(*factor));
  return factors;
}

void FieldMeasurement::fixLinearizationPoints(const Window& window) const {
  if (ParameterBlock* field = MagnetometerStates(window).field; field && !field->first)
    field->first = field->value;
}

std::shared_ptr<const Measurement> FieldMeasurement::weighted(int count) const {
  const double share = 1.0 / std::sqrt(static_cast<double>(count));
  auto weighted = std::make_shared<FieldMeasurement>(*this);
  weighted->noise.sigma_T *= share;
  weighted->noise.rotation_sigma_rad *= share;
  weighted->noise.tilt_sigma_rad *= share;
  return weighted;
}

}  // namespace lodeline
