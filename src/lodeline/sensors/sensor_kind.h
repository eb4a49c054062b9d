#pragma once

#include <array>
#include <tuple>
#include <type_traits>

#include "lodeline/rig.h"

namespace lodeline {

/// Readings of the kinds of sensors beside cameras and IMU. A new kind adds its type here, and a SensorKind.
using SensorSamples =
    std::tuple<MagnetometerSample, DepthSample, SonarSample, AltimeterSample, DvlSample, CurrentSample>;

/// Names and calibration of a kind of sensor, by the type of its readings:
///   `section`      section of a rig file, and folder of a EuRoC recording
///   `finding`      prefix of findings about its readings
///   `name`         in messages
///   `calibration`  member of Rig, which is empty without the sensor
template <typename Sample>
struct SensorKind;

template <>
struct SensorKind<MagnetometerSample> {
  static constexpr const char* section = "mag0";
  static constexpr const char* finding = "magnetometer";
  static constexpr const char* name = "magnetometer";
  static constexpr auto calibration = &Rig::magnetometer;
};

template <>
struct SensorKind<DepthSample> {
  static constexpr const char* section = "pressure0";
  static constexpr const char* finding = "depth";
  static constexpr const char* name = "pressure sensor";
  static constexpr auto calibration = &Rig::pressure;
};

template <>
struct SensorKind<SonarSample> {
  static constexpr const char* section = "sonar0";
  static constexpr const char* finding = "sonar";
  static constexpr const char* name = "sonar";
  static constexpr auto calibration = &Rig::sonar;
};

template <>
struct SensorKind<AltimeterSample> {
  static constexpr const char* section = "altimeter0";
  static constexpr const char* finding = "altimeter";
  static constexpr const char* name = "altimeter";
  static constexpr auto calibration = &Rig::altimeter;
};

template <>
struct SensorKind<DvlSample> {
  static constexpr const char* section = "dvl0";
  static constexpr const char* finding = "dvl";
  static constexpr const char* name = "DVL";
  static constexpr auto calibration = &Rig::dvl;
};

template <>
struct SensorKind<CurrentSample> {
  static constexpr const char* section = "current0";
  static constexpr const char* finding = "current";
  static constexpr const char* name = "current sensor";
  static constexpr auto calibration = &Rig::currents;
};

namespace sensor_kinds {

template <typename Samples>
struct List;
template <typename... Samples>
struct List<std::tuple<Samples...>> {
  template <template <typename> typename Holder>
  using Tuple = std::tuple<Holder<Samples>...>;
  static constexpr std::array single_sensors = {"imu0", SensorKind<Samples>::section...};
};

}  // namespace sensor_kinds

/// A tuple of one Holder<Sample> for each kind.
template <template <typename> typename Holder>
using PerSensorKind = sensor_kinds::List<SensorSamples>::Tuple<Holder>;

/// Sections of a rig file for the sensors of which a rig has one at most: IMU and other kinds.
inline constexpr std::array kSingleSensors = sensor_kinds::List<SensorSamples>::single_sensors;

/// Calls `visit` with the SensorKind of each kind, in the order of SensorSamples.
template <typename Visit>
void forEachSensorKind(const Visit& visit) {
  std::apply([&](const auto&... samples) { (visit(SensorKind<std::decay_t<decltype(samples)>>()), ...); },
             SensorSamples());
}

}  // namespace lodeline
