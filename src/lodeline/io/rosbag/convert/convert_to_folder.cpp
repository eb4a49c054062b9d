#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <unordered_map>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/current_table.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/folder_calibration.h"
#include "lodeline/io/images/image_loader.h"
#include "lodeline/io/robots/dvl_text.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/checked_reading.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/io/rosbag/convert/folder_parts.h"
#include "lodeline/io/rosbag/convert/rig_conversion.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/io/synchronizer/recording_file.h"

namespace lodeline {
namespace {

/// File name extension of an image file, determined from its first bytes.
std::string extensionOf(const std::vector<uint8_t>& file) {
  if (isPng(file)) return "png";
  const auto beginsWith = [&](std::string_view signature) {
    return file.size() > signature.size() && std::equal(signature.begin(), signature.end(), file.begin(),
                                                        [](char a, uint8_t b) { return a == char(b); });
  };
  if (beginsWith("\xff\xd8")) return "jpg";
  if (beginsWith("P5") || beginsWith("P2")) return "pgm";
  if (beginsWith("II*") || beginsWith("MM")) return "tif";
  if (beginsWith("BM")) return "bmp";
  return "img";
}

void writeBytes(const std::vector<uint8_t>& bytes, const std::filesystem::path& path) {
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw InputError(path.string() + ": could not be written in full; is the disk full?");
}

class FolderWriter {
 public:
  FolderWriter(RecordedSource* source, const std::filesystem::path& folder, const ConvertOptions& options,
               Diagnostics* diagnostics)
      : source_(source, options.part), folder_(folder), options_(options), diagnostics_(diagnostics) {}

  ConvertSummary run() {
    const Rig& rig = source_.rig();
    for (size_t i = 0; i < rig.cameras.size(); ++i) writeImages(i);
    writeReadings(
        "imu0", kImuColumns, [&] { return source_.nextRecordedImu(); },
        [](const ImuSample& s) {
          const Vec3& w = s.angular_velocity_B;
          const Vec3& f = s.specific_force_B;
          return fmt::format("{},{},{},{},{},{}", w.x(), w.y(), w.z(), f.x(), f.y(), f.z());
        });
    writeReadings(
        "mag0", kMagnetometerColumns, [&] { return source_.nextMagnetometer(); },
        [](const MagnetometerSample& s) {
          return fmt::format("{},{},{}", s.field_M.x(), s.field_M.y(), s.field_M.z());
        });
    writeReadings(
        "pressure0", kDepthColumns, [&] { return source_.nextDepth(); },
        [](const DepthSample& s) { return fmt::format("{}", s.depth_m); });
    writeReadings(
        "sonar0", kSonarColumns, [&] { return source_.nextSonar(); },
        [](const SonarSample& s) { return fmt::format("{},{}", s.range_m, s.angle_rad); });
    writeReadings(
        "altimeter0", kAltimeterColumns, [&] { return source_.nextAltimeter(); },
        [](const AltimeterSample& s) { return fmt::format("{}", s.range_m); });
    writeDvl();
    const std::vector<std::string> channels = rig.currents.value_or(CurrentCalibration()).channels;
    writeReadings(
        "current0", currentHeader(channels).c_str(), [&] { return source_.nextCurrents(); },
        [](const CurrentSample& s) { return fmt::format("{}", fmt::join(s.currents_A, ",")); });
    return std::move(summary_);
  }

  void writeTruth(BagFile* bag);
  void copyTables(const std::filesystem::path& mav0) {
    copyOtherTables(
        mav0, folder_ / "mav0", [&](Time time) { return source_.contains(time); }, &summary_.readings,
        diagnostics_);
  }

 private:
  std::filesystem::path sensor(const std::string& name) const { return folder_ / "mav0" / name; }

  template <typename Next, typename Text>
  void writeReadings(const std::string& name, const char* columns, const Next& next, const Text& text) {
    auto reading = next();
    if (!reading) return;
    RecordingFile file(sensor(name) / "data.csv");
    file.write(columns);
    for (; reading; reading = next()) {
      file.write(fmt::format("{},{}\n", reading->time.nanoseconds(), text(*reading)));
      ++summary_.readings[name];
    }
    file.close();
  }

  /// All pings are read first, because they decide which columns the table has.
  void writeDvl() {
    std::vector<DvlSample> pings;
    while (std::optional<DvlSample> ping = source_.nextDvl()) pings.push_back(std::move(*ping));
    if (pings.empty()) return;
    const DvlText text(pings);
    RecordingFile file(sensor("dvl0") / "data.csv");
    file.write(text.header());
    for (const DvlSample& ping : pings) file.write(text.rows(ping));
    summary_.readings["dvl0"] = static_cast<int>(pings.size());
    file.close();
  }

  void writeImages(size_t camera) {
    const std::string name = fmt::format("cam{}", camera);
    RecordingFile list(sensor(name) / "data.csv");
    list.write(kImageColumns);
    std::error_code error;
    std::filesystem::create_directories(sensor(name) / "data", error);
    std::unordered_map<int64_t, int> images_of_stamp;
    while (const std::optional<PendingImage> pending = source_.nextImage(camera)) {
      options_.progress(source_.shareRead().value_or(0.0));
      const int64_t stamp_ns = pending->time.nanoseconds();
      const int earlier = images_of_stamp[stamp_ns]++;
      const std::string stem =
          earlier == 0 ? fmt::format("{}", stamp_ns) : fmt::format("{}_{}", stamp_ns, earlier);
      const std::optional<std::string> file = writeImage(*pending, sensor(name) / "data", stem);
      if (!file) continue;
      list.write(fmt::format("{},{}\n", stamp_ns, *file));
      ++summary_.readings[name];
    }
    list.close();
  }

  /// Writes an image and returns the name of its file; reports an unavailable image and returns nothing.
  std::optional<std::string> writeImage(const PendingImage& pending, const std::filesystem::path& folder,
                                        const std::string& stem) {
    StoredImage image = pending.stored();
    if (!image.problem.empty()) {
      diagnostics_->report(Severity::Warning, "image_unreadable", image.problem + "; left out");
      return std::nullopt;
    }
    // Compression level 1 of 9, for speed.
    if (image.file.empty()) cv::imencode(".png", image.pixels, image.file, {cv::IMWRITE_PNG_COMPRESSION, 1});
    const std::string name = fmt::format("{}.{}", stem, extensionOf(image.file));
    writeBytes(image.file, folder / name);
    return name;
  }

  PartSource source_;
  std::filesystem::path folder_;
  const ConvertOptions& options_;
  Diagnostics* diagnostics_;
  ConvertSummary summary_;
};

void FolderWriter::writeTruth(BagFile* bag) {
  for (const BagTopic& topic : bag->topics()) {
    if (topic.connection.topic != kTruthTopic || topic.connection.type != messages::kPoseStamped.name)
      continue;
    size_t next = 0;
    const auto nextPose = [&]() -> std::optional<messages::StampedPosition> {
      while (next < topic.entries.size()) {
        const std::optional<wire::Bytes> message = bag->read(topic, topic.entries[next++]);
        std::string problem;
        if (!message) continue;
        const auto pose = messages::checkedReading(*message, messages::parsePoseStamped, &problem);
        if (pose && !source_.contains(pose->time)) continue;
        if (pose) return pose;
        diagnostics_->report(
            Severity::Warning, "bag_message",
            fmt::format("{} {}: {}; passed over", bag->file().string(), kTruthTopic, problem));
      }
      return std::nullopt;
    };
    writeReadings("state_groundtruth_estimate0",
                  "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
                  "q_RS_z []\n",
                  nextPose, [](const messages::StampedPosition& pose) {
                    const Vec3& p = pose.world_from_body.translation;
                    const Quat& q = pose.world_from_body.rotation;
                    return fmt::format("{},{},{},{},{},{},{}", p.x(), p.y(), p.z(), q.w(), q.x(), q.y(),
                                       q.z());
                  });
  }
}

void requireEmpty(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (std::filesystem::exists(folder, ignored) && !std::filesystem::is_empty(folder, ignored)) {
    throw InputError(folder.string() + ": is there already and not empty; choose another folder");
  }
}

void writeCalibration(const RigFile& rig_file, const std::filesystem::path& folder,
                      Diagnostics* diagnostics) {
  if (rig_file.sections.empty()) {
    diagnostics->report(
        Severity::Warning, "calibration_missing",
        fmt::format("{}: written without calibration, which `lodeline run` needs; describe the rig "
                    "with --rig FILE",
                    folder.string()));
  }
  writeFolderCalibration(rig_file, folder);
}

}  // namespace

ConvertSummary convertToFolder(RecordedSource* source, const RigFile& rig_file,
                               const std::filesystem::path& folder, const ConvertOptions& options,
                               Diagnostics* diagnostics) {
  requireEmpty(folder);
  ConvertSummary summary = FolderWriter(source, folder, options, diagnostics).run();
  writeCalibration(rig_file, folder, diagnostics);
  return summary;
}

ConvertSummary convertBagToFolder(const std::filesystem::path& bag, const std::filesystem::path& folder,
                                  const ConvertOptions& options, Diagnostics* diagnostics) {
  requireEmpty(folder);
  BagOptions bag_options;
  bag_options.rig_files = options.rig_files;
  bag_options.topics = options.topics;
  bag_options.camera_indices = options.cameras;
  bag_options.needs_calibration = false;
  BagSource source(bag, bag_options, diagnostics);
  FolderWriter writer(&source, folder, options, diagnostics);
  writer.writeTruth(&source.bag());
  ConvertSummary summary = writer.run();
  writeCalibration(numberedRig(source.rigFile(), options.cameras), folder, diagnostics);
  return summary;
}

ConvertSummary convertFolderToFolder(const std::filesystem::path& folder, const std::filesystem::path& target,
                                     const ConvertOptions& options, Diagnostics* diagnostics) {
  requireEmpty(target);
  EurocOptions folder_options = everythingIn(folder, options);
  folder_options.needs_imu = folder_options.needs_calibration = false;
  const EurocLayout layout = findEurocLayout(folder, folder_options);
  EurocSource source(folder, folder_options, diagnostics);
  FolderWriter writer(&source, target, options, diagnostics);
  writer.copyTables(layout.mav0);
  ConvertSummary summary = writer.run();
  Diagnostics reported_when_opened;
  const RigFile rig = readFolderCalibration(layout, &reported_when_opened);
  writeCalibration(numberedRig(rig, layout.camera_indices), target, diagnostics);
  return summary;
}

}  // namespace lodeline
