#include "lodeline/data/euroc_rig.h"

#include <fmt/core.h>

#include "lodeline/base/error.h"
#include "lodeline/data/csv_reader.h"
#include "lodeline/data/euroc_calibration.h"
#include "lodeline/data/kalibr_calibration.h"
#include "lodeline/data/stream_rate.h"

namespace lodeline {
namespace {

struct StreamStart {
  std::vector<Time> stamps;
  std::string why_empty;  ///< where there is no stamp
};

StreamStart readStart(const std::filesystem::path& csv, CsvContent content) {
  Diagnostics reported_when_read_in_earnest;
  CsvReader reader(csv, content, &reported_when_read_in_earnest);
  StreamStart start;
  CsvRow row;
  while (start.stamps.size() < kStampsForRate && reader.next(&row)) {
    start.stamps.push_back(row.time);
  }
  if (!start.stamps.empty()) return start;
  start.why_empty = fmt::format("{}: holds no usable row", csv.string());
  const std::vector<Finding> findings = reported_when_read_in_earnest.ranked();
  if (!findings.empty()) start.why_empty += fmt::format(" (first: {})", findings.front().first_message);
  return start;
}

/// For sensors that cannot be done without.
std::vector<Time> requireStamps(const std::filesystem::path& csv, CsvContent content, const char* advice) {
  StreamStart start = readStart(csv, content);
  if (start.stamps.empty()) throw InputError(fmt::format("{}; {}", start.why_empty, advice));
  return std::move(start.stamps);
}

/// Whether a sensor is to do with the default calibration, as it has none; reports it.
bool isUncalibrated(const EurocLayout& layout, const std::string& name, Diagnostics* diagnostics) {
  const std::filesystem::path file = layout.sensor(name) / "sensor.yaml";
  if (layout.needs_calibration || std::filesystem::exists(file)) return false;
  diagnostics->report(
      Severity::Warning, name + "_uncalibrated",
      fmt::format("{}: calibration file missing; {} is taken as it is, in body axes", file.string(), name));
  return true;
}

std::vector<CameraCalibration> readCameras(const EurocLayout& layout, const KalibrFiles& kalibr,
                                           const Rigid3& body_from_euroc_body, Diagnostics* diagnostics) {
  std::vector<CameraCalibration> chain;
  if (kalibr.camchain) chain = readKalibrCameras(*kalibr.camchain, diagnostics);
  std::vector<CameraCalibration> cameras;
  for (const int index : layout.camera_indices) {
    const std::string name = fmt::format("cam{}", index);
    const std::filesystem::path yaml = layout.sensor(name) / "sensor.yaml";
    CameraCalibration camera;
    if (kalibr.camchain) {
      if (index >= static_cast<int>(chain.size())) {
        throw InputError(fmt::format("{}: key '{}' is missing, but the recording has this camera",
                                     kalibr.camchain->string(), name));
      }
      camera = chain[static_cast<size_t>(index)];
      if (std::filesystem::exists(yaml)) {
        // Kalibr knows neither rates nor masks.
        const EurocCameraExtras extras = readEurocCameraExtras(yaml);
        camera.rate_hz = extras.rate_hz;
        camera.mask_file = extras.mask_file;
      }
    } else if (isUncalibrated(layout, name, diagnostics)) {
      camera.name = name;
      camera.rate_hz = 0.0;
    } else {
      camera = readEurocCamera(yaml, name, diagnostics);
      camera.body_from_camera = body_from_euroc_body * camera.body_from_camera;
    }
    const std::filesystem::path csv = layout.csv(name);
    const std::vector<Time> stamps =
        requireStamps(csv, CsvContent::Images, "restore it or leave this camera out (source.cameras)");
    camera.rate_hz = settleRate(csv.string(), stamps, camera.rate_hz, diagnostics);
    if (!(camera.rate_hz > 0.0)) camera.rate_hz = CameraCalibration().rate_hz;
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

/// A sensor that a recording may or may not have.
template <typename Calibration>
std::optional<Calibration> readOptional(const EurocLayout& layout, const char* name, CsvContent content,
                                        Rigid3 Calibration::*body_from_sensor,
                                        Calibration (*read)(const std::filesystem::path& file,
                                                            Diagnostics* diagnostics),
                                        const Rigid3& body_from_euroc_body, Diagnostics* diagnostics) {
  const std::filesystem::path csv = layout.csv(name);
  if (!std::filesystem::exists(csv)) return std::nullopt;
  const StreamStart start = readStart(csv, content);
  if (start.stamps.empty()) {
    diagnostics->report(Severity::Warning, "sensor_empty",
                        start.why_empty + "; carrying on without this sensor");
    return std::nullopt;
  }
  Calibration calibration;
  if (isUncalibrated(layout, name, diagnostics)) {
    calibration.rate_hz = 0.0;
  } else {
    calibration = read(layout.sensor(name) / "sensor.yaml", diagnostics);
  }
  calibration.*body_from_sensor = body_from_euroc_body * (calibration.*body_from_sensor);
  calibration.rate_hz = settleRate(csv.string(), start.stamps, calibration.rate_hz, diagnostics);
  if (!(calibration.rate_hz > 0.0)) calibration.rate_hz = Calibration().rate_hz;
  return calibration;
}

EurocImu readImu(const EurocLayout& layout, const KalibrFiles& kalibr, Diagnostics* diagnostics) {
  if (!layout.has_imu) return {};
  const std::filesystem::path yaml = layout.sensor("imu0") / "sensor.yaml";
  EurocImu imu;
  if (!kalibr.imu && isUncalibrated(layout, "imu0", diagnostics)) {
    imu.calibration.rate_hz = 0.0;
  } else if (!kalibr.imu || std::filesystem::exists(yaml)) {
    imu = readEurocImu(yaml, diagnostics);
  }
  if (kalibr.imu) {
    const double euroc_rate_hz = imu.calibration.rate_hz;
    imu.calibration = readKalibrImu(*kalibr.imu, diagnostics);
    if (!(imu.calibration.rate_hz > 0.0)) imu.calibration.rate_hz = euroc_rate_hz;
  }
  const std::vector<Time> stamps =
      requireStamps(layout.csv("imu0"), CsvContent::Imu, "the estimator cannot work without inertial data");
  imu.calibration.rate_hz =
      settleRate(layout.csv("imu0").string(), stamps, imu.calibration.rate_hz, diagnostics);
  if (!(imu.calibration.rate_hz > 0.0)) imu.calibration.rate_hz = ImuCalibration().rate_hz;
  return imu;
}

void reportKalibr(const EurocLayout& layout, const KalibrFiles& kalibr, Diagnostics* diagnostics) {
  for (const auto& [file, sensor] : {std::pair(kalibr.camchain, "cam0"), std::pair(kalibr.imu, "imu0")}) {
    if (!file || !std::filesystem::exists(layout.sensor(sensor) / "sensor.yaml")) continue;
    diagnostics->report(Severity::Notice, "kalibr_used",
                        fmt::format("calibration taken from {} instead of {}/sensor.yaml", file->string(),
                                    layout.sensor(sensor).string()));
  }
}

}  // namespace

Rig readEurocRig(const EurocLayout& layout, Diagnostics* diagnostics) {
  const std::filesystem::path beside =
      std::filesystem::absolute(layout.mav0).lexically_normal().parent_path();
  const KalibrFiles kalibr = findKalibrFiles({beside, layout.mav0});
  reportKalibr(layout, kalibr, diagnostics);

  const EurocImu imu = readImu(layout, kalibr, diagnostics);
  const Rigid3 body_from_euroc_body = imu.euroc_body_from_imu.inverse();
  Rig rig;
  rig.imu = imu.calibration;
  rig.cameras = readCameras(layout, kalibr, body_from_euroc_body, diagnostics);
  rig.magnetometer = readOptional<MagnetometerCalibration>(
      layout, "mag0", CsvContent::Magnetometer, &MagnetometerCalibration::body_from_magnetometer,
      readEurocMagnetometer, body_from_euroc_body, diagnostics);
  rig.pressure = readOptional<PressureCalibration>(layout, "pressure0", CsvContent::Depth,
                                                   &PressureCalibration::body_from_pressure,
                                                   readEurocPressure, body_from_euroc_body, diagnostics);
  rig.sonar =
      readOptional<SonarCalibration>(layout, "sonar0", CsvContent::Sonar, &SonarCalibration::body_from_sonar,
                                     readEurocSonar, body_from_euroc_body, diagnostics);
  return rig;
}

}  // namespace lodeline
