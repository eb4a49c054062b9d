#pragma once

#include <optional>
#include <vector>

#include "lodeline/estimator/sonar/sonar_range_factor.h"
#include "lodeline/rig.h"

namespace lodeline {

/// An echo as its sonar reports it, with the beam in body axes.
struct RawEcho {
  Time time;
  double range_m = 0.0;
  SonarBeam beam;
};

/// What all kinds of sonars have.
struct EchoSensor {
  double range_noise_std_m = 0.0;
  double beam_width_rad = 0.0;  ///< full width
  double max_range_m = 0.0;     ///< 0: unlimited
};

/// The echoes of a kind of readings, and names of the kind. `kInvalid` and `kRejected` are findings.
template <typename Sample>
struct EchoSource;

/// A scanning sonar.
template <>
struct EchoSource<SonarSample> {
  static constexpr const char* kName = "sonar";
  static constexpr const char* kInvalid = "sonar_invalid";
  static constexpr const char* kRejected = "sonar_rejected";
  static std::optional<EchoSource> of(const Rig& rig);
  void append(const SonarSample& sample, std::vector<RawEcho>* echoes) const;

  EchoSensor sensor;
  Rigid3 body_from_sonar;
};

/// An altimeter: a sonar with one beam along its x axis.
template <>
struct EchoSource<AltimeterSample> {
  static constexpr const char* kName = "altimeter";
  static constexpr const char* kInvalid = "altimeter_invalid";
  static constexpr const char* kRejected = "altimeter_rejected";
  static std::optional<EchoSource> of(const Rig& rig);
  void append(const AltimeterSample& sample, std::vector<RawEcho>* echoes) const;

  EchoSensor sensor;
  Rigid3 body_from_sonar;
};

/// The ranges of a DVL along its beams.
template <>
struct EchoSource<DvlSample> {
  static constexpr const char* kName = "dvl_range";
  static constexpr const char* kInvalid = "dvl_range_invalid";
  static constexpr const char* kRejected = "dvl_range_rejected";
  static std::optional<EchoSource> of(const Rig& rig);
  void append(const DvlSample& sample, std::vector<RawEcho>* echoes) const;

  EchoSensor sensor;
  Rigid3 body_from_dvl;
  std::vector<Vec3> beams_D;
};

}  // namespace lodeline
