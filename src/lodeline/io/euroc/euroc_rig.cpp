#include "lodeline/io/euroc/euroc_rig.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/folder_calibration.h"
#include "lodeline/io/euroc/image_list.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

struct StreamStart {
  std::vector<Time> stamps;
  std::string why_empty;  ///< reason why there is no stamp
};

StreamStart readStart(const std::filesystem::path& csv, CsvContent content, PlausibleRate rate) {
  Diagnostics reported_when_read_in_earnest;
  CsvReader reader(csv, content, &reported_when_read_in_earnest, rate);
  StreamStart start;
  CsvRow row, before;
  while (start.stamps.size() < kStampsForRate && reader.next(&row)) {
    // Rows that are written twice are left out of the rate measurement.
    const bool is_repeat = !start.stamps.empty() && row.time == before.time && row.numbers == before.numbers;
    if (!is_repeat) start.stamps.push_back(row.time);
    before = row;
  }
  if (!start.stamps.empty()) return start;
  start.why_empty = fmt::format("{}: holds no usable row", csv.string());
  const std::vector<Finding> findings = reported_when_read_in_earnest.ranked();
  if (!findings.empty()) start.why_empty += fmt::format(" (first: {})", findings.front().first_message);
  return start;
}

/// Stamps of a required sensor; throws InputError with `advice` where there is none.
std::vector<Time> requireStamps(const std::filesystem::path& csv, CsvContent content, PlausibleRate rate,
                                const char* advice) {
  StreamStart start = readStart(csv, content, rate);
  if (start.stamps.empty()) throw InputError(fmt::format("{}; {}", start.why_empty, advice));
  return std::move(start.stamps);
}

/// Sets the rate from the stated one and the stamps (settleRate), or to a usual value where neither
/// determines it.
void settle(const std::filesystem::path& csv, const std::vector<Time>& stamps, double usual_hz,
            double* rate_hz, Diagnostics* diagnostics) {
  *rate_hz = settleRate(csv.string(), stamps, *rate_hz, diagnostics);
  if (!(*rate_hz > 0.0)) *rate_hz = usual_hz;
}

double settleImageRate(const EurocLayout& layout, const std::string& camera, double stated_hz,
                       Diagnostics* diagnostics) {
  Diagnostics reported_when_read_in_earnest;
  ImageList list(layout.sensor(camera), &reported_when_read_in_earnest);
  if (!list.isMade()) {
    const std::vector<Time> stamps = requireStamps(layout.csv(camera), CsvContent::Images, kCameraRate,
                                                   "restore it or leave this camera out (source.cameras)");
    return settleRate(layout.csv(camera).string(), stamps, stated_hz, diagnostics);
  }
  std::vector<Time> stamps;
  while (stamps.size() < kStampsForRate) {
    const std::optional<ListedImage> image = list.next();
    if (!image) break;
    stamps.push_back(image->time);
  }
  return settleRate(list.origin().string(), stamps, stated_hz, diagnostics);
}

/// Reports cameras without an image list. Where other cameras have one, something is missing.
void reportLists(const EurocLayout& layout, Diagnostics* diagnostics) {
  const auto has_list = [&](int i) { return std::filesystem::exists(layout.csv(fmt::format("cam{}", i))); };
  const bool is_missing = std::any_of(layout.camera_indices.begin(), layout.camera_indices.end(), has_list);
  for (const int index : layout.camera_indices) {
    if (has_list(index)) continue;
    Diagnostics reported_when_read_in_earnest;
    const std::string name = fmt::format("cam{}", index);
    const ImageList list(layout.sensor(name), &reported_when_read_in_earnest);
    diagnostics->report(is_missing ? Severity::Warning : Severity::Notice, "image_list_made",
                        fmt::format("{}: missing; the list of images was made from {}",
                                    layout.csv(name).string(), list.origin().string()));
  }
  for (const auto& [index, problem] : layout.cameras_without_images) {
    diagnostics->report(Severity::Warning, "camera_left_out",
                        fmt::format("{}; cam{} is left out", problem, index));
  }
}

std::vector<CameraCalibration> settledCameras(const EurocLayout& layout, const Rig& described,
                                              Diagnostics* diagnostics) {
  std::vector<CameraCalibration> cameras;
  for (const int index : layout.camera_indices) {
    CameraCalibration camera;
    camera.name = fmt::format("cam{}", index);
    camera.rate_hz = 0.0;
    for (const CameraCalibration& known : described.cameras) {
      if (known.name == camera.name) camera = known;
    }
    camera.rate_hz = settleImageRate(layout, camera.name, camera.rate_hz, diagnostics);
    if (!(camera.rate_hz > 0.0)) camera.rate_hz = CameraCalibration().rate_hz;
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

/// Reads a sensor that a recording may lack.
template <typename Calibration>
std::optional<Calibration> settledOptional(const EurocLayout& layout, const char* name, CsvContent content,
                                           const std::optional<Calibration>& described,
                                           Diagnostics* diagnostics) {
  const std::filesystem::path csv = layout.csv(name);
  if (!std::filesystem::exists(csv)) return std::nullopt;
  const PlausibleRate rate = std::string_view(name) == "pressure0" ? kDepthRate : kMagnetometerRate;
  const StreamStart start = readStart(csv, content, rate);
  if (start.stamps.empty()) {
    diagnostics->report(Severity::Warning, "sensor_empty",
                        start.why_empty + "; carrying on without this sensor");
    return std::nullopt;
  }
  if (!described && layout.needs_calibration) {
    throw InputError(fmt::format(
        "{}: calibration file missing; write one (docs/reference/file-formats.md), describe {} in a rig "
        "file (--rig), or move its folder away",
        (layout.sensor(name) / "sensor.yaml").string(), name));
  }
  Calibration calibration;
  calibration.rate_hz = 0.0;
  if (described) calibration = *described;
  settle(csv, start.stamps, Calibration().rate_hz, &calibration.rate_hz, diagnostics);
  return calibration;
}

ImuCalibration settledImu(const EurocLayout& layout, const RigFile& described, Diagnostics* diagnostics) {
  if (!layout.has_imu) return {};
  ImuCalibration imu;
  imu.rate_hz = 0.0;
  if (described.has_imu) imu = described.rig.imu;
  const std::filesystem::path csv = layout.csv("imu0");
  const std::vector<Time> stamps =
      requireStamps(csv, CsvContent::Imu, kInertialRate, "the estimator cannot work without inertial data");
  settle(csv, stamps, ImuCalibration().rate_hz, &imu.rate_hz, diagnostics);
  return imu;
}

}  // namespace

Rig readEurocRig(const EurocLayout& layout, Diagnostics* diagnostics) {
  return settleEurocRig(layout, readFolderCalibration(layout, diagnostics), diagnostics);
}

Rig settleEurocRig(const EurocLayout& layout, const RigFile& described, Diagnostics* diagnostics) {
  reportLists(layout, diagnostics);
  Rig rig;
  rig.imu = settledImu(layout, described, diagnostics);
  rig.cameras = settledCameras(layout, described.rig, diagnostics);
  rig.magnetometer =
      settledOptional(layout, "mag0", CsvContent::Magnetometer, described.rig.magnetometer, diagnostics);
  rig.pressure = settledOptional(layout, "pressure0", CsvContent::Depth, described.rig.pressure, diagnostics);
  rig.sonar = settledOptional(layout, "sonar0", CsvContent::Sonar, described.rig.sonar, diagnostics);
  return rig;
}

}  // namespace lodeline
