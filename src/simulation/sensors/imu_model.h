#pragma once

#include <string_view>
#include <vector>

#include "lodeline/rig.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Errors of a three-axis inertial sensor in the unit of its reading [u] (rad/s or m/s^2):
///   reading = matrix * true + warm_up * exp(-t / warm_up_time) + b(t) + white noise.
/// It is clipped to the range. b(t) starts at `turn_on_bias` and adds a random walk and a flicker process
/// (bias instability).
struct TriadErrors {
  double noise_density = 0.0;     ///< [u]/sqrt(Hz), two-sided (Kalibr)
  double random_walk = 0.0;       ///< [u]/s/sqrt(Hz)
  double bias_instability = 0.0;  ///< [u], B of IEEE 952; Allan deviation minimum 0.664 B
  Vec3 turn_on_bias = Vec3::Zero();
  Mat3 matrix = Mat3::Identity();  ///< scale factors and misalignment
  Vec3 warm_up = Vec3::Zero();     ///< bias at power-on that decays with `warm_up_time_s`
  double warm_up_time_s = 400.0;
  double range = 1e9;  ///< readings are clipped to +-range
};

struct ImuErrors {
  TriadErrors gyroscope;
  TriadErrors accelerometer;
  /// Rate that the gyroscope reads per specific force, (rad/s) / (m/s^2); no part of its bias.
  Mat3 g_sensitivity = Mat3::Zero();
};

/// Datasheet values of a class of IMU: noise, and standard deviations of the systematic errors of a specimen.
struct ImuGrade {
  std::string_view name;
  double rate_hz;
  TriadErrors gyroscope, accelerometer;  ///< noise values and range; the other members are neutral
  double gyroscope_turn_on_rad_per_s, accelerometer_turn_on_m_per_s2;
  double scale_error, misalignment_rad;
  double gyroscope_warm_up_rad_per_s, accelerometer_warm_up_m_per_s2;
  double g_sensitivity_rad_s_per_m_s2;  ///< standard deviation of each element
};

/// Grades `gx5-25` (Microstrain 3DM-GX5-25), `gv7` (3DM-GV7) and `consumer` (MPU-9250 class). Throws
/// UsageError for any other name.
const ImuGrade& imuGrade(std::string_view name);
std::vector<std::string_view> imuGradeNames();

struct SpecimenOptions {
  bool noise = true;  ///< white noise, random walk and instability
  bool turn_on_bias = true;
  bool scale_and_misalignment = false;
  bool warm_up = false;
  bool g_sensitivity = false;
};
/// Draws one specimen of a grade. Each draw is independent of the selection of the others.
ImuErrors drawImuErrors(const ImuGrade& grade, const SpecimenOptions& options, uint64_t seed);

/// Noise values in a calibration file for such a sensor. The random walk is increased to the Allan deviation
/// of the bias instability at 100 s, as a model without a flicker term needs.
ImuNoise statedNoise(const ImuErrors& errors);

/// The drifting bias of three axes.
class DriftingBias {
 public:
  DriftingBias(const TriadErrors& errors, Random random);
  /// Advances by `step_s` > 0.
  void advance(double step_s);
  const Vec3& value() const { return value_; }

 private:
  // Flicker noise is a sum of first-order Gauss-Markov processes, two per decade of time constant.
  static constexpr int kProcesses = 9;
  static constexpr double kShortestTime_s = 1.0;

  TriadErrors errors_;
  Random random_;
  Vec3 walk_;
  Vec3 flicker_[kProcesses];
  Vec3 value_;
};

/// Converts perfect readings to those of a real IMU. Readings must be in order of time.
class ImuModel {
 public:
  ImuModel(const ImuErrors& errors, double rate_hz, uint64_t seed);

  ImuSample measure(const ImuSample& perfect);

  /// Bias in the last reading: the part added to (matrix * truth) besides white noise, including warm-up.
  const Vec3& gyroscopeBias() const { return gyroscope_bias_; }
  const Vec3& accelerometerBias() const { return accelerometer_bias_; }

 private:
  ImuErrors errors_;
  double rate_hz_;
  DriftingBias gyroscope_drift_, accelerometer_drift_;
  Random white_;
  bool started_ = false;
  Time start_, last_;
  Vec3 gyroscope_bias_ = Vec3::Zero(), accelerometer_bias_ = Vec3::Zero();
};

}  // namespace lodeline
