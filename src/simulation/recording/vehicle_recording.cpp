#include "simulation/recording/vehicle_recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "simulation/recording/recording_files.h"
#include "simulation/sensors/dvl_model.h"

namespace lodeline {
namespace {

constexpr double kTruthRate_hz = 10.0;

Time stampOf(const Dive& dive, double time_s) { return dive.start + Duration::fromSeconds(time_s); }

/// Calls `visit` with the time of every reading. `phase` is its place between two readings, because the
/// sensors have no common trigger.
template <typename Visit>
void forEachReading(const Dive& dive, double rate_hz, double phase, const Visit& visit) {
  for (int64_t i = 0;; ++i) {
    const double t = (static_cast<double>(i) + phase) / rate_hz;
    if (t > dive.motion.duration_s()) return;
    visit(t);
  }
}

std::string channelColumns(const Dive& dive) {
  std::string columns = "#timestamp [ns]";
  for (const std::string& name : dive.errors.truth.rig.currents->channels)
    columns += fmt::format(",{} [A]", name);
  return columns;
}

void recordSteel(const Dive& dive, const std::filesystem::path& truth) {
  RecordingFile dipoles(truth / "steel.csv");
  dipoles.write("#p_W_x [m],p_W_y [m],p_W_z [m],moment_W_x [A m^2],moment_W_y [A m^2],moment_W_z [A m^2]\n");
  for (const LyingDipole& d : dive.disturbances.steel) {
    dipoles.write(fmt::format("{:.4f},{:.4f},{:.4f},{:.6g},{:.6g},{:.6g}\n", d.position_W.x(),
                              d.position_W.y(), d.position_W.z(), d.moment_W.x(), d.moment_W.y(),
                              d.moment_W.z()));
  }
  dipoles.close();
  RecordingFile field(truth / "steel_field.csv");
  field.write("#timestamp [ns],m_W_x [T],m_W_y [T],m_W_z [T]\n");
  forEachReading(dive, kTruthRate_hz, 0.0, [&](double t) {
    const Vec3 m = fieldOfDipoles(dive.disturbances.steel, dive.motion.at(t).world_from_body.translation);
    field.write(
        fmt::format("{},{:.6e},{:.6e},{:.6e}\n", stampOf(dive, t).nanoseconds(), m.x(), m.y(), m.z()));
  });
  field.close();
}

}  // namespace

void recordAltimeter(const Dive& dive, const RangeFunction& range, const std::filesystem::path& mav0) {
  SonarModel model(dive.motion, dive.errors.truth.rig.altimeter->body_from_sonar, range,
                   dive.errors.altimeter, noiseSeed(dive.scenario), "altimeter");
  RecordingFile file(mav0 / "altimeter0" / "data.csv");
  file.write("#timestamp [ns],range [m]\n");
  forEachReading(dive, dive.scenario.rig.altimeter_rate_hz, 0.6, [&](double t) {
    const auto echo = model.measure(t);
    if (echo) file.write(fmt::format("{},{:.5f}\n", stampOf(dive, t).nanoseconds(), echo->range_m));
  });
  file.close();
}

void recordDvl(const Dive& dive, const RangeFunction& range, const std::filesystem::path& mav0) {
  const DvlCalibration& dvl = *dive.errors.truth.rig.dvl;
  DvlModel model(dive.motion, dvl.body_from_dvl, dvl.beams_D, range, dive.errors.dvl,
                 noiseSeed(dive.scenario));
  RecordingFile file(mav0 / "dvl0" / "data.csv");
  file.write("#timestamp [ns],beam,velocity [m/s],range [m],valid\n");
  forEachReading(dive, dive.scenario.rig.dvl_rate_hz, 0.4, [&](double t) {
    for (const DvlBeam& beam : model.measure(t).beams) {
      file.write(fmt::format("{},{},{:.5f},{:.4f},{}\n", stampOf(dive, t).nanoseconds(), beam.index,
                             beam.velocity_m_per_s.value_or(kDvlSentinel_m_per_s),
                             beam.range_m.value_or(kDvlSentinelRange_m), beam.velocity_m_per_s ? 1 : 0));
    }
  });
  file.close();
}

void recordCurrents(const Dive& dive, const std::filesystem::path& mav0) {
  CurrentSensorModel model(dive.loads, dive.errors.current_sensor, noiseSeed(dive.scenario));
  RecordingFile file(mav0 / "current0" / "data.csv");
  file.write(channelColumns(dive) + "\n");
  forEachReading(dive, dive.scenario.rig.current_rate_hz, 0.2, [&](double t) {
    file.write(fmt::format("{},{:.3f}\n", stampOf(dive, t).nanoseconds(), fmt::join(model.measure(t), ",")));
  });
  file.close();
}

std::string vehicleText(const Dive& dive) {
  const DiveErrors& e = dive.errors;
  const Quat misalignment =
      e.given.dvl->body_from_dvl.rotation.conjugate() * e.truth.rig.dvl->body_from_dvl.rotation;
  std::string text = fmt::format(
      "dvl: {{velocity_noise_m_per_s: {}, range_noise_m: {}, scale: {}, misalignment_rad: {}, "
      "dropout_share: {}, sentinel_share: {}}}\n"
      "altimeter: {{noise_m: {}, dropout_share: {}, spurious_share: {}}}\n"
      "currents:\n  noise_A: {}\n  resolution_A: {}\n  cables_moved: {}\n  fields_T_per_A:\n",
      e.dvl.velocity_noise_m_per_s, e.dvl.range_noise_m, e.dvl.scale, numbers(so3::log(misalignment)),
      e.dvl.dropout_share, e.dvl.sentinel_share, e.altimeter.noise_m, e.altimeter.dropout_share,
      e.altimeter.spurious_share, e.current_sensor.noise_A, e.current_sensor.resolution_A,
      dive.scenario.cables_moved);
  const CurrentCalibration& currents = *e.truth.rig.currents;
  for (size_t i = 0; i < currents.channels.size(); ++i)
    text += fmt::format("    {}: {}\n", currents.channels[i], numbers(currents.fields_T_per_A[i]));
  text += fmt::format("vibration: {}\nsteel_dipoles: {}\n",
                      dive.scenario.effects.has(Effect::Vibration) ? "on" : "off",
                      dive.disturbances.steel.size());
  return text;
}

void recordVehicleTruth(const Dive& dive, const std::filesystem::path& truth) {
  RecordingFile currents(truth / "currents.csv");
  currents.write(channelColumns(dive) + ",field_M_x [T],field_M_y [T],field_M_z [T]\n");
  const std::vector<Vec3>& fields = dive.errors.truth.rig.currents->fields_T_per_A;
  forEachReading(dive, kTruthRate_hz, 0.0, [&](double t) {
    const std::vector<double> currents_A = channelCurrents(dive.loads(t));
    const Vec3 m = fieldOfCurrents(fields, currents_A);
    currents.write(fmt::format("{},{:.6f},{:.6e},{:.6e},{:.6e}\n", stampOf(dive, t).nanoseconds(),
                               fmt::join(currents_A, ","), m.x(), m.y(), m.z()));
  });
  currents.close();
  if (dive.scenario.motion != MotionKind::CurrentRamps) {
    const Rigid3& body_from_dvl = dive.errors.truth.rig.dvl->body_from_dvl;
    RecordingFile dvl(truth / "dvl.csv");
    dvl.write("#timestamp [ns],v_x [m/s],v_y [m/s],v_z [m/s]\n");
    forEachReading(dive, kTruthRate_hz, 0.0, [&](double t) {
      const Vec3 v = instrumentVelocity_D(dive.motion.at(t), body_from_dvl);
      dvl.write(
          fmt::format("{},{:.7f},{:.7f},{:.7f}\n", stampOf(dive, t).nanoseconds(), v.x(), v.y(), v.z()));
    });
    dvl.close();
  }
  if (!dive.disturbances.steel.empty()) recordSteel(dive, truth);
}

}  // namespace lodeline
