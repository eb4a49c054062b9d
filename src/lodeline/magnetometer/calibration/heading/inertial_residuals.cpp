#include "lodeline/magnetometer/calibration/heading/inertial_residuals.h"

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

using namespace inertial_parameter;

Vec3 InertialParameters::field_W() const { return Vec3(0.0, std::cos(dip_rad), -std::sin(dip_rad)); }

InertialParameters moved(const InertialParameters& from, const Eigen::Matrix<double, kSize, 1>& step) {
  InertialParameters to = from;
  to.soft_iron += symmetricMatrix(step.segment<6>(kSoftIron));
  to.hard_iron += step.segment<3>(kHardIron);
  to.body_from_magnetometer =
      (so3::exp(step.segment<3>(kRotation)) * from.body_from_magnetometer).normalized();
  to.dip_rad += step[kDip];
  to.gyroscope_bias_B += step.segment<3>(kGyroscopeBias);
  to.time_offset_s += step[kTimeOffset];
  to.accelerometer_bias_B += step.segment<3>(kAccelerometerBias);
  return to;
}

InertialResidual fieldResidual(const Vec3& reading, const Mat3& mean_turn, const Vec3& rate_B,
                               const Quat& world_from_body, const InertialParameters& p) {
  const Mat3 body_from_world = world_from_body.toRotationMatrix().transpose();
  const Mat3 sensor_from_body = p.soft_iron * p.body_from_magnetometer.toRotationMatrix().transpose();
  const Vec3 field_B = body_from_world * p.field_W();
  const Vec3 mean_B = mean_turn * field_B;
  const Vec3 field_M = p.body_from_magnetometer.conjugate() * mean_B;
  const Vec3 by_dip_W(0.0, -std::sin(p.dip_rad), -std::cos(p.dip_rad));

  InertialResidual r;
  r.value = reading - p.soft_iron * field_M - p.hard_iron;
  r.by_rotation = -sensor_from_body * mean_turn * so3::skew(field_B);
  auto& j = r.by_parameters;
  j.middleCols<6>(kSoftIron) << -field_M.x(), 0, 0, -field_M.y(), -field_M.z(), 0,  //
      0, -field_M.y(), 0, -field_M.x(), 0, -field_M.z(),                            //
      0, 0, -field_M.z(), 0, -field_M.x(), -field_M.y();
  j.middleCols<3>(kHardIron) = -Mat3::Identity();
  j.middleCols<3>(kRotation) = -sensor_from_body * so3::skew(mean_B);
  j.col(kDip) = -sensor_from_body * mean_turn * body_from_world * by_dip_W;
  // In body axes, the field rotates opposite to the body: d field_B / dt = -rate x field_B.
  j.col(kTimeOffset) = sensor_from_body * rate_B.cross(mean_B);
  return r;
}

InertialResidual gravityResidual(const Vec3& specific_force_B, const Quat& world_from_body,
                                 const InertialParameters& p) {
  const Vec3 up_B = world_from_body.conjugate() * -standardGravity_W();
  InertialResidual r;
  r.value = specific_force_B - p.accelerometer_bias_B - up_B;
  r.by_rotation = -so3::skew(up_B);
  r.by_parameters.middleCols<3>(kAccelerometerBias) = -Mat3::Identity();
  return r;
}

TurnResidual turnResidual(const Quat& first_from_second, const Mat3& by_bias, const Quat& world_from_first,
                          const Quat& world_from_second) {
  const Quat measured = world_from_first.conjugate() * world_from_second;
  TurnResidual r;
  r.value = so3::log(first_from_second.conjugate() * measured);
  const Mat3 inverse_right = so3::rightJacobianInverse(r.value);
  r.by_second = inverse_right;
  r.by_first = -inverse_right * measured.toRotationMatrix().transpose();
  r.by_bias = -so3::rightJacobianInverse(-r.value) * by_bias;
  return r;
}

}  // namespace lodeline
