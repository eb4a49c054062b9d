#include <fmt/core.h>

#include <functional>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/images/image_loader.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/io/rosbag/convert/folder_parts.h"
#include "lodeline/io/rosbag/convert/rig_conversion.h"
#include "lodeline/io/rosbag/definitions/message_fields.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"

namespace lodeline {
namespace {

/// A reading that is not written yet.
struct Outgoing {
  Time time;
  std::function<void()> write;
};
using Pull = std::function<std::optional<Outgoing>()>;

/// Writes the readings of several streams in the order of their stamps; each stream keeps its own order.
void merge(const std::vector<Pull>& streams, const std::function<void()>& written) {
  std::vector<std::optional<Outgoing>> heads;
  for (const Pull& pull : streams) heads.push_back(pull());
  while (true) {
    std::optional<size_t> first;
    for (size_t i = 0; i < heads.size(); ++i) {
      if (heads[i] && (!first || heads[i]->time < heads[*first]->time)) first = i;
    }
    if (!first) return;
    heads[*first]->write();
    written();
    heads[*first] = streams[*first]();
  }
}

/// Writes a recording as a bag.
class RecordingConversion {
 public:
  RecordingConversion(RecordedSource* source, const std::filesystem::path& bag, const ConvertOptions& options,
                      Diagnostics* diagnostics)
      : source_(source, options.part),
        diagnostics_(diagnostics),
        progress_(options.progress),
        writer_(makeBagWriter(bag, options.format, options.compression)) {}

  /// `truth`: table of true poses; may be missing.
  ConvertSummary run(const std::filesystem::path& truth) {
    std::vector<Pull> streams;
    for (size_t i = 0; i < source_.rig().cameras.size(); ++i) {
      streams.push_back([this, i] { return image(i); });
    }
    streams.push_back([this] { return imu(); });
    streams.push_back([this] { return magnetometer(); });
    streams.push_back([this] { return depth(); });
    streams.push_back([this] { return sonar(); });
    streams.push_back([this] { return altimeter(); });
    streams.push_back([this] { return dvl(); });
    streams.push_back([this] { return currents(); });
    std::optional<CsvReader> truth_reader;
    if (std::filesystem::exists(truth)) {
      truth_reader.emplace(truth, CsvContent::TruePose, diagnostics_);
      streams.push_back([&] { return truePose(&*truth_reader); });
    }
    merge(streams, [this] { progress_(source_.shareRead().value_or(0.0)); });
    writer_->close();
    return std::move(summary_);
  }

  const std::map<std::string, std::string>& topics() const { return topics_; }

 private:
  /// Counts and writes a message of a sensor. A bag returns messages in the order of their reception times,
  /// so these must not decrease even where the stamps do.
  void write(const std::string& sensor, const std::string& topic, const messages::Type& type, Time stamp,
             wire::Bytes message) {
    Time& received = received_.try_emplace(sensor, stamp).first->second;
    received = std::max(received, stamp);
    topics_[sensor] = topic;
    ++summary_.readings[sensor];
    writer_->write(topic, type.name, received, std::move(message));
  }

  uint32_t sequence(const std::string& sensor) { return static_cast<uint32_t>(summary_.readings[sensor]); }

  void reportRounded(const std::string& what, Time time, double given, double kept) {
    if (given == kept) return;
    diagnostics_->report(Severity::Notice, "convert_rounded",
                         fmt::format("{} {} at {} ns is kept as {}: the message holds no more", what, given,
                                     time.nanoseconds(), kept));
  }

  std::optional<Outgoing> imu() {
    const std::optional<ImuSample> sample = source_.nextRecordedImu();
    if (!sample) return std::nullopt;
    return Outgoing{sample->time, [this, sample] {
                      write("imu0", "/imu0", messages::kImu, sample->time,
                            messages::imu(*sample, sequence("imu0")));
                    }};
  }

  std::optional<Outgoing> magnetometer() {
    const std::optional<MagnetometerSample> sample = source_.nextMagnetometer();
    if (!sample) return std::nullopt;
    return Outgoing{sample->time, [this, sample] {
                      write("mag0", "/mag0", messages::kMagneticField, sample->time,
                            messages::magneticField(*sample, sequence("mag0")));
                    }};
  }

  std::optional<Outgoing> depth() {
    const std::optional<DepthSample> sample = source_.nextDepth();
    if (!sample) return std::nullopt;
    return Outgoing{sample->time, [this, sample] {
                      const WaterColumn water;
                      reportRounded("depth", sample->time, sample->depth_m,
                                    water.depth_m(water.pressure_Pa(sample->depth_m)));
                      write("pressure0", "/pressure0", messages::kFluidPressure, sample->time,
                            messages::fluidPressure(*sample, water, sequence("pressure0")));
                    }};
  }

  std::optional<Outgoing> sonar() {
    const std::optional<SonarSample> sample = source_.nextSonar();
    if (!sample) return std::nullopt;
    return Outgoing{sample->time, [this, sample] {
                      wire::Bytes message = messages::laserScan(*sample, sequence("sonar0"));
                      const std::vector<SonarSample> kept = messages::parseLaserScan(message);
                      if (!kept.empty()) {
                        reportRounded("sonar range", sample->time, sample->range_m, kept.front().range_m);
                        reportRounded("sonar angle", sample->time, sample->angle_rad, kept.front().angle_rad);
                      }
                      write("sonar0", "/sonar0", messages::kLaserScan, sample->time, std::move(message));
                    }};
  }

  std::optional<Outgoing> altimeter() {
    const std::optional<AltimeterSample> sample = source_.nextAltimeter();
    if (!sample) return std::nullopt;
    return Outgoing{sample->time, [this, sample] {
                      wire::Bytes message = messages::altimeterRange(*sample, sequence("altimeter0"));
                      const std::vector<AltimeterSample> kept = messages::parseAltimeter(message);
                      if (!kept.empty())
                        reportRounded("altimeter range", sample->time, sample->range_m, kept.front().range_m);
                      write("altimeter0", "/altimeter0", messages::kRange, sample->time, std::move(message));
                    }};
  }

  std::optional<Outgoing> dvl() {
    const std::optional<DvlSample> sample = source_.nextDvl();
    if (!sample) return std::nullopt;
    return Outgoing{sample->time, [this, sample] {
                      for (const DvlBeam& beam : sample->beams) reportBeam(*sample, beam);
                      write("dvl0", "/dvl0", messages::kMarineDvl, sample->time,
                            messages::marineDvl(*sample, source_.rig().dvl->beams_D, sequence("dvl0")));
                    }};
  }

  /// Reports what the message does not hold of a beam.
  void reportBeam(const DvlSample& sample, const DvlBeam& beam) {
    if (static_cast<size_t>(beam.index) >= messages::kMarineBeams) {
      diagnostics_->report(Severity::Warning, "convert_left_out",
                           fmt::format("dvl0: beam {} at {} ns is left out: the message has {} beams",
                                       beam.index, sample.time.nanoseconds(), messages::kMarineBeams));
    } else if (beam.velocity_m_per_s) {
      reportRounded("velocity of a beam", sample.time, *beam.velocity_m_per_s,
                    messages::decimal(static_cast<float>(*beam.velocity_m_per_s)));
    }
  }

  std::optional<Outgoing> currents() {
    const std::optional<CurrentSample> sample = source_.nextCurrents();
    if (!sample) return std::nullopt;
    return Outgoing{
        sample->time, [this, sample] {
          write("current0", "/current0", messages::kJointState, sample->time,
                messages::jointCurrents(*sample, source_.rig().currents->channels, sequence("current0")));
        }};
  }

  std::optional<Outgoing> image(size_t camera) {
    std::optional<PendingImage> pending = source_.nextImage(camera);
    if (!pending) return std::nullopt;
    const Time time = pending->time;
    return Outgoing{time, [this, camera, pending = std::move(*pending)] { writeImage(camera, pending); }};
  }

  /// The first image of a camera determines the type of its messages, because a topic has one type.
  void writeImage(size_t camera, const PendingImage& pending) {
    const std::string sensor = fmt::format("cam{}", camera);
    StoredImage stored = pending.stored();
    const bool is_raw = raw_.try_emplace(sensor, stored.file.empty() || isPng(stored.file)).first->second;
    if (stored.problem.empty() && is_raw && !stored.file.empty()) {
      stored.pixels = cv::imdecode(stored.file, cv::IMREAD_UNCHANGED);
      if (stored.pixels.empty()) stored.problem = pending.name + ": image damaged or of unknown kind";
    }
    if (!stored.problem.empty()) {
      diagnostics_->report(Severity::Warning, "image_unreadable", stored.problem + "; left out");
      return;
    }
    const std::string topic = fmt::format("/{}/image_raw", sensor);
    if (is_raw) {
      write(sensor, topic, messages::kImage, pending.time,
            messages::image(pending.time, sensor, stored.pixels, sequence(sensor)));
    } else {
      write(sensor, topic + "/compressed", messages::kCompressedImage, pending.time,
            messages::compressedImage(pending.time, sensor, stored.file, sequence(sensor)));
    }
  }

  std::optional<Outgoing> truePose(CsvReader* reader) {
    CsvRow row;
    do {
      if (!reader->next(&row)) return std::nullopt;
    } while (!source_.contains(row.time));
    if (!row.text.empty()) {
      diagnostics_->report(Severity::Notice, "convert_truth",
                           fmt::format("{}: velocities and biases are left out; a bag keeps the true poses",
                                       reader->file().string()));
    }
    const std::vector<double>& n = row.numbers;
    const messages::StampedPosition pose{row.time, Rigid3(Quat(n[3], n[4], n[5], n[6]), Vec3(n.data()))};
    return Outgoing{row.time, [this, pose] {
                      write("truth", kTruthTopic, messages::kPoseStamped, pose.time,
                            messages::poseStamped(pose, sequence("truth")));
                    }};
  }

  PartSource source_;
  Diagnostics* diagnostics_;
  std::function<void(double)> progress_;
  std::unique_ptr<BagWriter> writer_;
  ConvertSummary summary_;
  std::map<std::string, Time> received_;
  std::map<std::string, std::string> topics_;
  std::map<std::string, bool> raw_;
};

}  // namespace

void requireAbsent(const std::filesystem::path& bag) {
  for (const std::filesystem::path& file : {bag, rigFileBeside(bag)}) {
    if (std::filesystem::exists(file)) {
      throw InputError(file.string() + ": is there already; choose another name or delete it");
    }
  }
}

ConvertSummary convertFolderToBag(const std::filesystem::path& folder, const std::filesystem::path& bag,
                                  const ConvertOptions& options, Diagnostics* diagnostics) {
  requireAbsent(bag);
  const std::filesystem::path rig_file = rigFileBeside(bag);
  const EurocOptions folder_options = everythingIn(folder, options);
  const EurocLayout layout = findEurocLayout(folder, folder_options);
  EurocSource source(folder, folder_options, diagnostics);
  RecordingConversion conversion(&source, bag, options, diagnostics);
  ConvertSummary summary = conversion.run(layout.csv("state_groundtruth_estimate0"));
  writeRigFile(layout, conversion.topics(), rig_file);
  summary.rig_file = rig_file;
  return summary;
}

ConvertSummary convertToBag(RecordedSource* source, const RigFile& rig, const std::filesystem::path& bag,
                            const ConvertOptions& options, Diagnostics* diagnostics) {
  requireAbsent(bag);
  RecordingConversion conversion(source, bag, options, diagnostics);
  ConvertSummary summary = conversion.run({});
  if (rig.sections.empty()) {
    diagnostics->report(Severity::Warning, "calibration_missing",
                        fmt::format("{}: written without calibration, which `lodeline run` needs; describe "
                                    "the rig with --rig FILE",
                                    bag.string()));
    return summary;
  }
  summary.rig_file = rigFileBeside(bag);
  writeRigFile(rig, conversion.topics(), summary.rig_file);
  return summary;
}

}  // namespace lodeline
