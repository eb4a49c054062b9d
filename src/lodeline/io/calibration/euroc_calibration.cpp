#include "lodeline/io/calibration/euroc_calibration.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/camera_keys.h"
#include "lodeline/io/calibration/imu_keys.h"
#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// A number that must be positive, or 0 where `may_be_zero`.
double checked(const std::string& key, bool may_be_zero, CalibrationMap* map) {
  const double value = map->number(key);
  if (value > 0.0 || (may_be_zero && value == 0.0)) return value;
  throw InputError(fmt::format("{} is {:g}; it must {}", map->at(key), value,
                               may_be_zero ? "not be negative" : "be positive"));
}

double positive(const std::string& key, CalibrationMap* map) { return checked(key, false, map); }

double rateOrUnknown(CalibrationMap* map) { return map->has("rate_hz") ? positive("rate_hz", map) : 0.0; }

std::string maskOrNone(CalibrationMap* map) {
  if (!map->has("mask")) return {};
  const std::filesystem::path mask = map->file().parent_path() / map->text("mask");
  if (!std::filesystem::is_regular_file(mask)) {
    throw InputError(fmt::format("{} names {}, which does not exist", map->at("mask"), mask.string()));
  }
  return mask.string();
}

/// Reads a sensor with only extrinsics, rate and one noise value.
template <typename Calibration>
Calibration readSmallSensor(Rigid3 Calibration::*body_from_sensor, const std::string& noise_key,
                            double Calibration::*noise, CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  Calibration calibration;
  calibration.*body_from_sensor = map->transform("T_BS");
  calibration.rate_hz = rateOrUnknown(map);
  calibration.*noise = positive(noise_key, map);
  return calibration;
}

double checkedOr(const std::string& key, double fallback, bool may_be_zero, CalibrationMap* map) {
  return map->has(key) ? checked(key, may_be_zero, map) : fallback;
}

/// Beams at an angle to z, at azimuths from x towards y.
std::vector<Vec3> beamsAtAngle(CalibrationMap* map) {
  const double angle_rad = map->number("angle_deg") * kDegree;
  if (!(angle_rad > 0.0) || !(angle_rad < 0.5 * M_PI))
    throw InputError(map->atLine("angle_deg") + " must lie between 0 and 90: the angle of a beam to z");
  std::vector<Vec3> beams_D;
  for (const double azimuth_deg : map->numbers("azimuths_deg")) {
    const double azimuth = azimuth_deg * kDegree;
    beams_D.emplace_back(std::sin(angle_rad) * std::cos(azimuth), std::sin(angle_rad) * std::sin(azimuth),
                         std::cos(angle_rad));
  }
  map->refuseUnknownKeys();
  return beams_D;
}

std::vector<Vec3> beamsOfVectors(CalibrationMap* map) {
  const std::vector<double> numbers = map->numbers("beams");
  if (numbers.size() % 3 != 0)
    throw InputError(fmt::format("{} has {} numbers where each beam is a vector [x, y, z]",
                                 map->atLine("beams"), numbers.size()));
  std::vector<Vec3> beams_D;
  for (size_t i = 0; i < numbers.size(); i += 3) {
    constexpr double kTolerance = 1e-2;
    const Vec3 beam(numbers[i], numbers[i + 1], numbers[i + 2]);
    if (!(std::abs(beam.norm() - 1.0) < kTolerance))
      throw InputError(fmt::format("{}: beam {} has the length {:.4g}; it must be a unit vector",
                                   map->atLine("beams"), i / 3, beam.norm()));
    beams_D.push_back(beam.normalized());
  }
  return beams_D;
}

std::vector<Vec3> beamsOf(CalibrationMap* map) {
  std::vector<Vec3> beams_D;
  if (map->node()["beams"].IsMap() && !map->node()["beams"]["data"].IsDefined()) {
    CalibrationMap beams = *map->section("beams");
    beams_D = beamsAtAngle(&beams);
  } else {
    beams_D = beamsOfVectors(map);
  }
  if (beams_D.size() < 3)
    throw InputError(fmt::format("{} describes {} beams; a velocity needs three or more",
                                 map->atLine("beams"), beams_D.size()));
  return beams_D;
}

/// Adds a channel with its field, if it states one.
void addChannel(const std::string& name, CalibrationMap* channels, CurrentCalibration* currents) {
  currents->channels.push_back(name);
  if (channels->node()[name].IsNull()) return;
  std::optional<CalibrationMap> channel = channels->section(name);
  if (!channel) return;
  if (channel->has("field_T_per_A")) currents->fields_T_per_A.push_back(channel->vector3("field_T_per_A"));
  channel->refuseUnknownKeys();
}

void readChannels(CalibrationMap* map, CurrentCalibration* currents) {
  const YAML::Node node = map->node()["channels"];
  if (node.IsSequence()) {
    for (const YAML::Node& name : node) {
      if (!name.IsScalar()) throw InputError(map->atLine("channels") + " is no list of names");
      currents->channels.push_back(name.Scalar());
    }
  } else {
    CalibrationMap channels = *map->section("channels");
    for (const auto& entry : node) addChannel(entry.first.Scalar(), &channels, currents);
  }
  const size_t fields = currents->fields_T_per_A.size();
  if (fields == 0 || fields == currents->channels.size()) return;
  throw InputError(fmt::format("{}: {} of {} channels have a field_T_per_A; give it for all or for none",
                               map->atLine("channels"), fields, currents->channels.size()));
}

}  // namespace

EurocImu readEurocImu(CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  EurocImu imu;
  if (map->has("T_BS")) imu.euroc_body_from_imu = map->transform("T_BS");
  imu.calibration.rate_hz = rateOrUnknown(map);
  imu.calibration.noise = readImuNoise(map);
  imu.correction = readImuCorrection(map);
  return imu;
}

EurocCameraExtras readEurocCameraExtras(CalibrationMap* map) { return {rateOrUnknown(map), maskOrNone(map)}; }

CameraCalibration readEurocCamera(const std::string& name, CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  CameraCalibration camera;
  camera.name = name;
  readCameraModel("distortion_coefficients", map, &camera);
  if (!map->has("T_BS")) {
    throw InputError(
        fmt::format("{} (camera to IMU) is missing: this is the calibration of a camera alone. Calibrate "
                    "camera and IMU together (Kalibr), or add a rig file with "
                    "`{}: {{T_BS: …}}`",
                    map->at("T_BS"), name));
  }
  camera.body_from_camera = map->transform("T_BS");
  camera.rate_hz = rateOrUnknown(map);
  camera.time_offset_to_imu_s = map->numberOr("timeshift_cam_imu", 0.0);
  camera.mask_file = maskOrNone(map);
  return camera;
}

MagnetometerCalibration readEurocMagnetometer(CalibrationMap* map) {
  using Calibration = MagnetometerCalibration;
  return readSmallSensor(&Calibration::body_from_magnetometer, "magnetometer_noise_density",
                         &Calibration::noise_density_T_per_sqrtHz, map);
}

PressureCalibration readEurocPressure(CalibrationMap* map) {
  using Calibration = PressureCalibration;
  return readSmallSensor(&Calibration::body_from_pressure, "depth_noise_std", &Calibration::depth_noise_std_m,
                         map);
}

SonarCalibration readEurocSonar(CalibrationMap* map) {
  using Calibration = SonarCalibration;
  Calibration calibration =
      readSmallSensor(&Calibration::body_from_sonar, "range_noise_std", &Calibration::range_noise_std_m, map);
  if (map->has("beam_width")) calibration.beam_width_rad = positive("beam_width", map);
  if (map->has("max_range")) calibration.max_range_m = positive("max_range", map);
  return calibration;
}

DvlCalibration readDvl(CalibrationMap* map) {
  map->ignore({"sensor_type", "comment"});
  DvlCalibration dvl;
  dvl.body_from_dvl = map->transform("T_BS");
  dvl.rate_hz = checkedOr("rate_hz", 0.0, false, map);
  dvl.velocity_noise_std_m_per_s = checked("velocity_noise_std", false, map);
  dvl.range_noise_std_m = checkedOr("range_noise_std", dvl.range_noise_std_m, false, map);
  if (map->has("beams")) dvl.beams_D = beamsOf(map);
  dvl.scale_sigma = checkedOr("scale_sigma", dvl.scale_sigma, true, map);
  dvl.misalignment_sigma_rad = checkedOr("misalignment_sigma", dvl.misalignment_sigma_rad, true, map);
  dvl.time_offset_to_imu_s = map->numberOr("timeshift", 0.0);
  return dvl;
}

CurrentCalibration readCurrents(CalibrationMap* map) {
  map->ignore({"sensor_type", "comment", "T_BS"});
  CurrentCalibration currents;
  currents.rate_hz = checkedOr("rate_hz", 0.0, false, map);
  if (map->has("channels")) readChannels(map, &currents);
  currents.field_sigma_T_per_A = checkedOr("field_sigma_T_per_A", 0.0, true, map);
  currents.time_offset_to_imu_s = map->numberOr("timeshift", 0.0);
  return currents;
}

}  // namespace lodeline
