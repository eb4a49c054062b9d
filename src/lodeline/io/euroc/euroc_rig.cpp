#include "lodeline/io/euroc/euroc_rig.h"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/current_table.h"
#include "lodeline/io/euroc/dvl_table.h"
#include "lodeline/io/euroc/folder_calibration.h"
#include "lodeline/io/euroc/image_list.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

struct StreamStart {
  std::vector<Time> stamps;
  std::string why_empty;  ///< reason why there is no stamp
};

/// The first stamps of a table. `open` returns a function that returns the next stamp.
template <typename Open>
StreamStart readStartOf(const std::filesystem::path& csv, const Open& open) {
  Diagnostics reported_when_read_in_earnest;
  auto next = open(&reported_when_read_in_earnest);
  StreamStart start;
  while (start.stamps.size() < kStampsForRate) {
    const std::optional<Time> stamp = next();
    if (!stamp) break;
    start.stamps.push_back(*stamp);
  }
  if (!start.stamps.empty()) return start;
  start.why_empty = fmt::format("{}: holds no usable row", csv.string());
  const std::vector<Finding> findings = reported_when_read_in_earnest.ranked();
  if (!findings.empty()) start.why_empty += fmt::format(" (first: {})", findings.front().first_message);
  return start;
}

/// A function that returns the stamps of a table.
template <typename Table>
auto nextTime(const std::shared_ptr<Table>& table) {
  return [table]() -> std::optional<Time> {
    const auto reading = table->next();
    return reading ? std::optional(reading->time) : std::nullopt;
  };
}

StreamStart readStart(const std::filesystem::path& csv, CsvContent content, PlausibleRate rate) {
  return readStartOf(csv, [&](Diagnostics* diagnostics) {
    const auto reader = std::make_shared<CsvReader>(csv, content, diagnostics, rate);
    return [reader, before = std::optional<CsvRow>()]() mutable -> std::optional<Time> {
      CsvRow row;
      // Rows that are written twice are left out of the rate measurement.
      do {
        if (!reader->next(&row)) return std::nullopt;
      } while (before && row.time == before->time && row.numbers == before->numbers);
      before = row;
      return row.time;
    };
  });
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

/// Reads a sensor that a recording may lack. `read_start`: reads the first stamps of its table.
template <typename Calibration, typename Start>
std::optional<Calibration> settledOptional(const EurocLayout& layout, const char* name,
                                           const std::optional<Calibration>& described,
                                           const Start& read_start, Diagnostics* diagnostics) {
  const std::filesystem::path csv = layout.csv(name);
  if (!std::filesystem::exists(csv)) return std::nullopt;
  const StreamStart start = read_start(csv);
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

/// Reads the sensors whose tables have several rows for a reading, or columns with other names.
void settleRobotSensors(const EurocLayout& layout, const Rig& known, Rig* rig, Diagnostics* diagnostics) {
  const size_t beams = known.dvl.value_or(DvlCalibration()).beams_D.size();
  const auto dvlStart = [&](const std::filesystem::path& csv) {
    return readStartOf(
        csv, [&](Diagnostics* ignored) { return nextTime(std::make_shared<DvlTable>(csv, beams, ignored)); });
  };
  rig->dvl = settledOptional(layout, "dvl0", known.dvl, dvlStart, diagnostics);
  std::vector<std::string> channels = known.currents.value_or(CurrentCalibration()).channels;
  const auto currentStart = [&](const std::filesystem::path& csv) {
    return readStartOf(csv, [&](Diagnostics* ignored) {
      const auto table = std::make_shared<CurrentTable>(csv, channels, ignored);
      channels = table->channels();
      return nextTime(table);
    });
  };
  rig->currents = settledOptional(layout, "current0", known.currents, currentStart, diagnostics);
  if (rig->currents) rig->currents->channels = channels;
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
  const auto startOf = [](CsvContent content, PlausibleRate rate) {
    return [content, rate](const std::filesystem::path& csv) { return readStart(csv, content, rate); };
  };
  const Rig& known = described.rig;
  rig.magnetometer = settledOptional(layout, "mag0", known.magnetometer,
                                     startOf(CsvContent::Magnetometer, kMagnetometerRate), diagnostics);
  rig.pressure = settledOptional(layout, "pressure0", known.pressure, startOf(CsvContent::Depth, kDepthRate),
                                 diagnostics);
  rig.sonar = settledOptional(layout, "sonar0", known.sonar, startOf(CsvContent::Sonar, kMagnetometerRate),
                              diagnostics);
  rig.altimeter = settledOptional(layout, "altimeter0", known.altimeter,
                                  startOf(CsvContent::Altimeter, kDepthRate), diagnostics);
  settleRobotSensors(layout, known, &rig, diagnostics);
  return rig;
}

}  // namespace lodeline
