#include "lodeline/estimator/sonar/echo_source.h"

#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Full width of the beams of a DVL: 4.4 degrees for common ones of 1 MHz (Water Linked A50).
constexpr double kDvlBeamWidth_rad = 0.077;

EchoSensor sensorOf(const SonarCalibration& sonar) {
  return {sonar.range_noise_std_m, sonar.beam_width_rad, sonar.max_range_m};
}

/// The beam of a head that is turned about its z axis.
SonarBeam turnedBeam(const Rigid3& body_from_sonar, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Mat3 axes_S;
  axes_S << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return {body_from_sonar.translation, body_from_sonar.rotation.toRotationMatrix() * axes_S};
}

}  // namespace

std::optional<EchoSource<SonarSample>> EchoSource<SonarSample>::of(const Rig& rig) {
  if (!rig.sonar) return std::nullopt;
  return EchoSource{sensorOf(*rig.sonar), rig.sonar->body_from_sonar};
}

void EchoSource<SonarSample>::append(const SonarSample& sample, std::vector<RawEcho>* echoes) const {
  echoes->push_back({sample.time, sample.range_m, turnedBeam(body_from_sonar, sample.angle_rad)});
}

std::optional<EchoSource<AltimeterSample>> EchoSource<AltimeterSample>::of(const Rig& rig) {
  if (!rig.altimeter) return std::nullopt;
  return EchoSource{sensorOf(*rig.altimeter), rig.altimeter->body_from_sonar};
}

void EchoSource<AltimeterSample>::append(const AltimeterSample& sample, std::vector<RawEcho>* echoes) const {
  echoes->push_back({sample.time, sample.range_m, turnedBeam(body_from_sonar, 0.0)});
}

std::optional<EchoSource<DvlSample>> EchoSource<DvlSample>::of(const Rig& rig) {
  if (!rig.dvl) return std::nullopt;
  return EchoSource{
      {rig.dvl->range_noise_std_m, kDvlBeamWidth_rad, 0.0}, rig.dvl->body_from_dvl, rig.dvl->beams_D};
}

void EchoSource<DvlSample>::append(const DvlSample& sample, std::vector<RawEcho>* echoes) const {
  for (const DvlBeam& beam : sample.beams) {
    if (!beam.range_m || beam.index < 0 || beam.index >= static_cast<int>(beams_D.size())) continue;
    const Vec3& along_D = beams_D[static_cast<size_t>(beam.index)];
    Mat3 axes_D;
    axes_D << along_D, tangentBasis(along_D);
    echoes->push_back({sample.time,
                       *beam.range_m,
                       {body_from_dvl.translation, body_from_dvl.rotation.toRotationMatrix() * axes_D}});
  }
}

}  // namespace lodeline
