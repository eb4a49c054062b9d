#include "simulation/recording/truth_recording.h"

#include <fmt/format.h>

#include <numbers>

#include "lodeline/geometry/so3.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "simulation/recording/recording_files.h"
#include "simulation/recording/vehicle_recording.h"

namespace lodeline {
namespace {

std::string triadText(const char* name, const TriadErrors& e) {
  return fmt::format(
      "{}:\n  noise_density: {}\n  random_walk: {}\n  bias_instability: {}\n  turn_on_bias: {}\n  matrix: "
      "{}\n"
      "  warm_up: {}\n  warm_up_time_s: {}\n  range: {}\n",
      name, e.noise_density, e.random_walk, e.bias_instability, numbers(e.turn_on_bias), numbers(e.matrix),
      numbers(e.warm_up), e.warm_up_time_s, e.range);
}

std::string portText(const PortWindow& port, double fit_rms_px) {
  std::string shape;
  if (const auto* plate = std::get_if<FlatPort>(&port)) {
    shape = fmt::format("flat_port: {{normal_C: {}, distance_m: {}, thickness_m: {}",
                        numbers(plate->normal_C), plate->distance_m, plate->thickness_m);
  } else {
    const DomePort& dome = std::get<DomePort>(port);
    shape = fmt::format("dome_port: {{centre_C: {}, radius_m: {}, thickness_m: {}", numbers(dome.centre_C),
                        dome.radius_m, dome.thickness_m);
  }
  return shape + fmt::format(", index_glass: {}, index_water: {}, fit_rms_px: {}}}\n", glassIndex(port),
                             waterIndex(port), fit_rms_px);
}

// What only a part of the recordings has: rolling shutter, g-sensitivity, and what moves in the water.
std::string rareText(const Dive& dive) {
  std::string text;
  if (dive.errors.readout_s > 0.0) {
    text += fmt::format("rolling_shutter: {{readout_s: {}, line_delay_s: {}}}\n", dive.errors.readout_s,
                        dive.errors.readout_s / dive.scenario.rig.height_px);
  }
  if (!dive.errors.imu.g_sensitivity.isZero()) {
    text +=
        fmt::format("gyroscope_g_sensitivity_rad_s_per_m_s2: {}\n", numbers(dive.errors.imu.g_sensitivity));
  }
  if (dive.current) {
    const Vec3 carried = dive.current->values.back();
    const double duration_s = dive.current->step_s * static_cast<double>(dive.current->values.size() - 1);
    text += fmt::format("current: {{mean_velocity_W: {}}}\n", numbers(Vec3(carried / duration_s)));
  }
  if (!dive.fish.empty()) text += fmt::format("fish_schools: {}\n", dive.fish.size());
  if (dive.buddy) text += fmt::format("buddy: {{kick_hz: {}}}\n", dive.buddy->kick_hz);
  if (dive.halocline) {
    text += fmt::format("halocline: {{height_W: {}, thickness_m: {}, index_step: {}, density_step: {}}}\n",
                        dive.halocline->height_W, dive.halocline->thickness_m, dive.halocline->index_step,
                        dive.errors.pressure.density_step);
  }
  return text;
}

// Errors of the calibration files as angles and lengths.
std::string calibrationText(const DiveErrors& e) {
  std::string text = "calibration_files:\n";
  for (size_t i = 0; i < e.given.cameras.size(); ++i) {
    const CameraCalibration& given = e.given.cameras[i];
    const CameraCalibration& truth = e.in_water.cameras[i];
    const Rigid3 off = truth.body_from_camera.inverse() * given.body_from_camera;
    text += fmt::format(
        "  {}: {{focal_length_percent: {}, principal_point_px: [{}, {}], rotation_deg: {}, position_m: "
        "{}}}\n",
        given.name, 100.0 * (given.fx_px / truth.fx_px - 1.0), given.cx_px - truth.cx_px,
        given.cy_px - truth.cy_px, so3::log(off.rotation).norm() * 180.0 / std::numbers::pi,
        off.translation.norm());
  }
  if (e.port) {
    text += portText(*e.port, e.port_fit_rms_px);
    for (const CameraCalibration& c : e.truth.rig.cameras) {
      text += fmt::format("{}_in_air: {{intrinsics: [{}, {}, {}, {}]}}\n", c.name, c.fx_px, c.fy_px, c.cx_px,
                          c.cy_px);
    }
  }
  return text;
}

std::string magneticText(const Dive& dive) {
  const MagnetometerErrors& m = dive.errors.magnetometer;
  const FieldElements field = fieldElements(dive.field_W);
  std::string text = fmt::format(
      "field_W_T: {}\ndeclination_deg: {}\ninclination_deg: {}\nmagnetometer:\n  soft_iron: {}\n  "
      "hard_iron_T: {}\n"
      "  hard_iron_creep_T_per_s: {}\n  rotation_body_from_magnetometer: {}\n  noise_density_T_per_sqrtHz: "
      "{}\n"
      "  lag_s: {}\n  repeat_share: {}\n  range_T: {}\n  resolution_T: {}\n",
      numbers(dive.field_W), field.declination_rad * 180.0 / std::numbers::pi,
      field.inclination_rad * 180.0 / std::numbers::pi, numbers(m.soft_iron), numbers(m.hard_iron_T),
      numbers(m.hard_iron_creep_T_per_s), numbers(Mat3(m.body_from_magnetometer.rotation.toRotationMatrix())),
      m.noise_density_T_per_sqrtHz, m.lag_s, m.repeat_share, m.range_T, m.resolution_T);
  text += "lying_dipoles:\n";
  for (const LyingDipole& d : dive.disturbances.lying) {
    text += fmt::format("  - {{position_W: {}, moment_W: {}}}\n", numbers(d.position_W), numbers(d.moment_W));
  }
  text += "passing_iron:\n";
  for (const PassingIron& p : dive.disturbances.passing) {
    text += fmt::format("  - {{begin_s: {}, duration_s: {}, ramp_s: {}, position_B: {}, moment_W: {}}}\n",
                        p.begin_s, p.duration_s, p.ramp_s, numbers(p.position_B), numbers(p.moment_W));
  }
  text += "switched_currents:\n";
  for (const SwitchedCurrent& c : dive.disturbances.switched) {
    text += fmt::format("  - {{begin_s: {}, duration_s: {}, field_B_T: {}}}\n", c.begin_s, c.duration_s,
                        numbers(c.field_B));
  }
  return text;
}

std::string otherText(const Dive& dive, const RenderSettings& settings) {
  const DiveErrors& e = dive.errors;
  std::string text = fmt::format(
      "pressure: {{noise_m: {}, resolution_m: {}, offset_m: {}, lag_s: {}, density_ratio: {}}}\n"
      "surface_height_m: {}\n"
      "sonar: {{noise_m: {}, dropout_share: {}, spurious_share: {}, resolution_m: {}}}\n"
      "camera_clock: {{delay_s: {}, drift_ppm: {}, jitter_s: {}, dropped_share: {}}}\n"
      "water: {{attenuation_per_m: {}, scattering_share: {}}}\nsilt:\n",
      e.pressure.noise_m, e.pressure.resolution_m, e.pressure.offset_m, e.pressure.lag_s,
      e.pressure.density_ratio, dive.surface_height_m, e.sonar.noise_m, e.sonar.dropout_share,
      e.sonar.spurious_share, e.sonar.resolution_m, e.camera_clock.delay_s, e.camera_clock.drift_ppm,
      e.camera_clock.jitter_s, e.dropped_image_share, settings.water.attenuation_per_m,
      settings.water.scattering_share);
  for (const SiltEpisode& s : settings.water.silt) {
    text += fmt::format("  - {{start_s: {}, duration_s: {}, peak_attenuation_per_m: {}}}\n", s.start_s,
                        s.duration_s, s.peak_attenuation_per_m);
  }
  return text;
}

void recordLandmarks(const Dive& dive, const RangeFunction& range, const std::filesystem::path& path) {
  Random random(dive.scenario.seed, "truth/landmarks");
  std::string points;
  int count = 0;
  for (double t = 0.0; t < dive.motion.duration_s(); t += 0.02) {
    const Vec3 origin = dive.motion.at(t).world_from_body.translation;
    const Vec3 direction = random.direction();
    const auto distance = range(origin, direction);
    if (!distance || *distance > 10.0) continue;
    const Vec3 point = origin + *distance * direction;
    points += fmt::format("{:.5f} {:.5f} {:.5f}\n", point.x(), point.y(), point.z());
    ++count;
  }
  RecordingFile file(path);
  file.write(
      fmt::format("ply\nformat ascii 1.0\ncomment points of the true surface, world frame, m\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
                  count));
  file.write(points);
  file.close();
}

void recordCave(const FramedCave& cave, const Scenario& scenario, const std::filesystem::path& truth) {
  RecordingFile place(truth / "cave.yaml");
  place.write(fmt::format(
      "# p_W = p_C + world_from_cave_m: W is the world of this dive, C the frame of the cave (both east, "
      "north,\n"
      "# up). Dives with the same scenario, length, laps and cave seed share C.\n"
      "cave: {}\ncave_seed: {}\ndive_seed: {}\nentrance: {}\nworld_from_cave_m: {}\n",
      scenario.name, *scenario.cave_seed, scenario.seed, scenario.entrance, numbers(cave.origin_W)));
  place.close();
  if (cave.tags.empty()) return;
  RecordingFile tags(truth / "tags.csv");
  tags.write("#tag,size [m],centre_x [m],centre_y [m],centre_z [m]");
  for (int k = 0; k < 4; ++k) tags.write(fmt::format(",corner{0}_x [m],corner{0}_y [m],corner{0}_z [m]", k));
  tags.write("\n");
  for (const LineTag& tag : cave.tags) {
    const Vec3& centre_C = tag.cave_from_tag.translation;
    tags.write(fmt::format("{},{},{:.6f},{:.6f},{:.6f}", tag.id, tag.size_m, centre_C.x(), centre_C.y(),
                           centre_C.z()));
    for (int k = 0; k < 4; ++k) {
      const Vec3 corner_C = tag.corner_C(k);
      tags.write(fmt::format(",{:.6f},{:.6f},{:.6f}", corner_C.x(), corner_C.y(), corner_C.z()));
    }
    tags.write("\n");
  }
  tags.close();
}

std::string lampsText(const RenderSettings& settings) {
  std::string text = "lamps:\n";
  for (const Lamp& lamp : settings.lamps) {
    text += fmt::format("  - {{position_B: {}, spot_W_per_sr: {}, flood_W_per_sr: {}}}\n",
                        numbers(lamp.position_B), lamp.spot_intensity, lamp.flood_intensity);
  }
  return text;
}

}  // namespace

void recordTruth(const Dive& dive, const RenderSettings& settings, const std::vector<ScheduledImage>& images,
                 const RangeFunction& range, const std::filesystem::path& folder) {
  const std::filesystem::path truth = folder / "truth";
  Rig rig = dive.errors.in_water;
  rig.imu.noise = {dive.errors.imu.gyroscope.noise_density, dive.errors.imu.gyroscope.random_walk,
                   dive.errors.imu.accelerometer.noise_density, dive.errors.imu.accelerometer.random_walk};
  writeCalibration(rig, truth / "calibration");

  RecordingFile errors(truth / "errors.yaml");
  errors.write(triadText("gyroscope", dive.errors.imu.gyroscope));
  errors.write(triadText("accelerometer", dive.errors.imu.accelerometer));
  errors.write(calibrationText(dive.errors));
  errors.write(magneticText(dive));
  errors.write(otherText(dive, settings));
  errors.write(rareText(dive));
  if (dive.cave) errors.write(lampsText(settings));
  if (dive.scenario.vehicle) errors.write(vehicleText(dive));
  errors.close();

  if (dive.scenario.vehicle) recordVehicleTruth(dive, truth);
  if (dive.cave) recordCave(*dive.cave, dive.scenario, truth);
  if (!images.empty()) {
    RecordingFile times(truth / "image_times.csv");
    times.write("#camera,stamp [ns],middle of exposure on the IMU clock [ns]\n");
    for (const ScheduledImage& image : images) {
      times.write(fmt::format("{},{},{}\n", image.camera, image.stamp.nanoseconds(),
                              (dive.start + Duration::fromSeconds(image.middle_s)).nanoseconds()));
    }
    times.close();
  }
  if (range) recordLandmarks(dive, range, truth / "landmarks.ply");
}

}  // namespace lodeline
