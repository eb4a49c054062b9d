#include "lodeline/io/calibration/imu_keys.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

double density(const std::string& key, CalibrationMap* map) {
  const double value = map->number(key);
  if (!(value > 0.0)) {
    throw InputError(
        fmt::format("{} is {:g}; it must be a positive density (from the datasheet or an Allan analysis)",
                    map->at(key), value));
  }
  return value;
}

/// Maximum condition number. The axes of a working sensor are orthogonal to a few per cent and degrees.
constexpr double kGreatestCondition = 3.0;

Mat3 inverseOf(const Mat3& matrix, const std::string& where) {
  const Vec3 sizes = Eigen::JacobiSVD<Mat3>(matrix).singularValues();
  if (!(matrix.allFinite() && matrix.determinant() > 0.0 && sizes(0) < kGreatestCondition * sizes(2))) {
    throw InputError(fmt::format(
        "{}: the matrix cannot be the scale and misalignment of a sensor (singular values {:.3g}, "
        "{:.3g}, {:.3g}, determinant {:.3g}); calibrate again",
        where, sizes(0), sizes(1), sizes(2), matrix.determinant()));
  }
  return matrix.inverse();
}

Mat3 matrixOr(const std::string& key, const Mat3& fallback, CalibrationMap* map) {
  return map->has(key) ? map->matrix3(key) : fallback;
}

Mat3 rotationOr(const std::string& key, CalibrationMap* map) {
  const Mat3 rotation = matrixOr(key, Mat3::Identity(), map);
  if ((rotation * rotation.transpose() - Mat3::Identity()).norm() > 1e-3) {
    throw InputError(map->atLine(key) + " is not a rotation");
  }
  return rotation;
}

void refuseLevers(CalibrationMap* map) {
  for (const char* key : {"rx_i", "ry_i", "rz_i"}) {
    if (!map->has(key) || map->vector3(key).isZero(1e-4)) continue;
    throw InputError(
        fmt::format("{} puts an axis of the accelerometer {:.1f} mm from the IMU's origin, which is not "
                    "supported; calibrate with --imu-models scale-misalignment",
                    map->atLine(key), map->vector3(key).norm() * 1e3));
  }
}

void readKalibrMatrices(CalibrationMap* map, ImuCorrection* correction) {
  if (std::optional<CalibrationMap> gyroscopes = map->section("gyroscopes")) {
    const Mat3 gyroscope_from_imu = rotationOr("C_gyro_i", &*gyroscopes);
    const Mat3 axes = matrixOr("M", Mat3::Identity(), &*gyroscopes) * gyroscope_from_imu;
    correction->gyroscope = inverseOf(axes, gyroscopes->at("M"));
    correction->g_sensitivity = matrixOr("A", Mat3::Zero(), &*gyroscopes) * gyroscope_from_imu;
    if (gyroscopes->has("bias")) correction->gyroscope_bias = gyroscopes->vector3("bias");
    gyroscopes->refuseUnknownKeys();
  }
  if (std::optional<CalibrationMap> accelerometers = map->section("accelerometers")) {
    correction->accelerometer =
        inverseOf(matrixOr("M", Mat3::Identity(), &*accelerometers), accelerometers->at("M"));
    if (accelerometers->has("bias")) correction->accelerometer_bias = accelerometers->vector3("bias");
    refuseLevers(&*accelerometers);
    accelerometers->refuseUnknownKeys();
  }
}

void readOpenVinsMatrices(CalibrationMap* map, ImuCorrection* correction) {
  bool has_any = false;
  for (const char* key : {"Tw", "R_IMUtoGYRO", "Tg", "Ta", "R_IMUtoACC"}) has_any = map->has(key) || has_any;
  if (!has_any) return;
  const Mat3 identity = Mat3::Identity();
  correction->gyroscope =
      inverseOf(matrixOr("Tw", identity, map) * rotationOr("R_IMUtoGYRO", map), map->at("Tw"));
  correction->accelerometer =
      inverseOf(matrixOr("Ta", identity, map) * rotationOr("R_IMUtoACC", map), map->at("Ta"));
  correction->g_sensitivity = matrixOr("Tg", Mat3::Zero(), map);
}

void requireKnownModel(CalibrationMap* map) {
  if (!map->has("model")) return;
  const std::string model = map->text("model");
  const bool needs_matrices = model == "scale-misalignment" || model == "scale-misalignment-size-effect";
  if (needs_matrices && (!map->has("gyroscopes") || !map->has("accelerometers"))) {
    throw InputError(fmt::format("{} is '{}', but gyroscopes or accelerometers with its matrices are missing",
                                 map->atLine("model"), model));
  }
  if (needs_matrices || model == "calibrated" || model == "kalibr" || model == "rpng") return;
  throw InputError(fmt::format("{} is '{}'; known are calibrated, scale-misalignment, kalibr and rpng",
                               map->atLine("model"), model));
}

}  // namespace

std::optional<ImuCorrection> readImuCorrection(CalibrationMap* map) {
  requireKnownModel(map);
  ImuCorrection correction;
  readOpenVinsMatrices(map, &correction);
  readKalibrMatrices(map, &correction);
  correction.time_offset_s = map->numberOr("time_offset", 0.0);
  return correction.isIdentity() ? std::nullopt : std::optional(correction);
}

ImuNoise readImuNoise(CalibrationMap* map) {
  ImuNoise noise;
  noise.gyroscope_density_rad_per_s_sqrtHz = density("gyroscope_noise_density", map);
  noise.gyroscope_random_walk_rad_per_s2_sqrtHz = density("gyroscope_random_walk", map);
  noise.accelerometer_density_m_per_s2_sqrtHz = density("accelerometer_noise_density", map);
  noise.accelerometer_random_walk_m_per_s3_sqrtHz = density("accelerometer_random_walk", map);
  if (map->has("axes_sigma")) {
    noise.axes_sigma = map->number("axes_sigma");
    if (!(*noise.axes_sigma > 0.0) || *noise.axes_sigma > 0.2) {
      throw InputError(fmt::format("{} is {:g}; it must be a relative error above 0 and below 0.2",
                                   map->atLine("axes_sigma"), *noise.axes_sigma));
    }
  }
  return noise;
}

}  // namespace lodeline
