#include "lodeline/io/rosbag/bag_source.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

/// Gives every sensor in the bag a calibration, even a meaningless one.
void addUncalibrated(const BagFile& bag, RigFile* rig_file) {
  Rig& rig = rig_file->rig;
  rig_file->has_imu = true;
  const size_t cameras = imageTopics(bag).size();
  if (cameras == 0) rig.cameras.clear();
  while (rig.cameras.size() < cameras) {
    CameraCalibration camera;
    camera.name = fmt::format("cam{}", rig.cameras.size());
    camera.rate_hz = 0.0;
    rig.cameras.push_back(camera);
  }
  forEachSensorKind([&](auto kind) {
    auto& sensor = rig.*kind.calibration;
    if (sensor || topicsFor(bag, kind.section).empty()) return;
    sensor.emplace();
    sensor->rate_hz = 0.0;  // no stated rate
  });
  if (!rig_file->sections.contains("imu0")) rig.imu.rate_hz = 0.0;
}

std::vector<std::string> singleSensorsOf(const Rig& rig) {
  std::vector<std::string> sensors = {"imu0"};
  forEachSensorKind([&](auto kind) {
    if (rig.*kind.calibration) sensors.emplace_back(kind.section);
  });
  return sensors;
}

TopicWish wishOf(const RigFile& rig_file, const BagOptions& options) {
  TopicWish wish;
  wish.named = rig_file.topics;
  for (const auto& [sensor, topic] : options.topics) wish.named[sensor] = topic;
  Rig used = rig_file.rig;
  selectCameras(options.camera_indices, "source.cameras", &used);
  for (const CameraCalibration& camera : rig_file.rig.cameras) wish.rig_cameras.push_back(camera.name);
  for (const CameraCalibration& camera : used.cameras) {
    if (options.with_cameras) wish.cameras.push_back(camera.name);
  }
  wish.sensors = singleSensorsOf(rig_file.rig);
  return wish;
}

constexpr const char* kStampAdvice =
    "use a driver that fills the header's stamp, or give --received-times, which takes the times at which "
    "the "
    "messages were recorded: milliseconds late and uneven, so that one camera may not start and poses are "
    "worse";

/// Throws for header stamps that advance much faster or slower than the recording times.
void refuseOtherClock(const std::string& name, const std::vector<Time>& stamps,
                      const std::vector<Time>& received) {
  constexpr double kOtherUnit = 100.0;
  const auto rate_hz = [](const std::vector<Time>& times) {
    std::vector<double> since_first_s;
    for (const Time time : times) since_first_s.push_back((time - times.front()).seconds());
    return stampsPerUnit(since_first_s);
  };
  const double by_stamps_hz = rate_hz(stamps), by_recording_hz = rate_hz(received);
  if (!(by_stamps_hz > 0.0) || !(by_recording_hz > 0.0)) return;
  if (by_stamps_hz < kOtherUnit * by_recording_hz && by_recording_hz < kOtherUnit * by_stamps_hz) return;
  throw InputError(
      fmt::format("{}: by their header stamps the messages come at {:.4g} Hz, by the times of their "
                  "recording at {:.4g} Hz: the stamps count another unit; {}",
                  name, by_stamps_hz, by_recording_hz, kStampAdvice));
}

messages::ImageForm formOf(const BagTopic& topic) {
  return topic.connection.type == messages::kImage.name ? messages::ImageForm::Raw
                                                        : messages::ImageForm::Compressed;
}

}  // namespace

BagSource::BagSource(const std::filesystem::path& bag, const BagOptions& options, Diagnostics* diagnostics)
    : RecordedSource(Rig()),
      bag_(openBagFile(bag, diagnostics)),
      diagnostics_(diagnostics),
      rig_file_(readRigOf(bag, "a bag", options.rig_files, options.needs_calibration, diagnostics)),
      use_received_times_(options.use_received_times) {
  if (!options.needs_calibration) addUncalibrated(*bag_, &rig_file_);
  if (!rig_file_.has_imu) {
    throw InputError(
        fmt::format("{}: the rig file has no section imu0 (or Kalibr's imu.yaml is missing); its noise "
                    "densities are needed",
                    bag.string()));
  }
  refuseUnknownTopics(options);
  choice_ = chooseTopics(bag_.get(), wishOf(rig_file_, options), diagnostics);
  rig_ = rig_file_.rig;
  imu_correction_ = rig_file_.imu_correction;
  if (!options.with_cameras) rig_.cameras.clear();
  settleCameras(options);
  imu_ = cursorOf("imu0");
  accelerometer_ = {choice_.accelerometer, 0};
  forEachSensorKind([&](auto kind) { sensors_[kind.section] = cursorOf(kind.section); });
  if (options.needs_calibration && imu_.topic == nullptr) {
    throw InputError(fmt::format("{}: has no topic of type {}; inertial readings are needed", bag.string(),
                                 messages::kImu.name));
  }
  forEachSensorKind([&](auto kind) {
    if (sensors_[kind.section].topic == nullptr) (rig_.*kind.calibration).reset();
  });
  settleRates();
  settleRobotSensors();
}

void BagSource::refuseUnknownTopics(const BagOptions& options) const {
  std::vector<std::string> sensors;
  for (const CameraCalibration& camera : rig_file_.rig.cameras) sensors.push_back(camera.name);
  for (const std::string& sensor : singleSensorsOf(rig_file_.rig)) sensors.push_back(sensor);
  for (const auto& [sensor, topic] : options.topics) {
    if (std::find(sensors.begin(), sensors.end(), sensor) != sensors.end()) continue;
    throw UsageError(fmt::format("--topic {}={}: the rig has no {}; it has {}", sensor, topic, sensor,
                                 fmt::join(sensors, ", ")));
  }
}

void BagSource::settleCameras(const BagOptions& options) {
  if (options.needs_calibration && options.with_cameras && rig_.cameras.empty()) {
    throw InputError(
        fmt::format("{}: the rig file describes no camera; a trajectory cannot be estimated without "
                    "images",
                    bag_->file().string()));
  }
  selectCameras(options.camera_indices, bag_->file().string(), &rig_);
  for (const CameraCalibration& camera : rig_.cameras) cameras_.push_back(cursorOf(camera.name));
}

BagSource::Cursor BagSource::cursorOf(const std::string& sensor) const { return {choice_.of(sensor), 0}; }

std::vector<Time> BagSource::firstStamps(Cursor cursor, const std::string& name) {
  std::vector<Time> stamps, received;
  wire::Bytes before;
  while (stamps.size() < kStampsForRate) {
    std::optional<wire::Bytes> message = nextMessage(&cursor);
    if (!message) break;
    // Messages that were recorded twice are left out of the rate measurement.
    if (*message == before) continue;
    std::string reported_when_read_in_earnest;
    const auto stamp = messages::checkedReading(*message, messages::stampOf, &reported_when_read_in_earnest);
    if (!stamp) continue;
    stamps.push_back(*stamp);
    received.push_back(cursor.topic->entries[cursor.next - 1].received);
    before = std::move(*message);
  }
  if (use_received_times_) return received;
  refuseOtherClock(name, stamps, received);
  return stamps;
}

void BagSource::settleRates() {
  const auto settle = [&](const Cursor& cursor, double fallback_hz, double* rate_hz) {
    if (cursor.topic == nullptr) return;
    const std::string name = fmt::format("{} {}", bag_->file().string(), cursor.topic->connection.topic);
    *rate_hz = settleRate(name, firstStamps(cursor, name), *rate_hz, diagnostics_, kStampAdvice);
    if (!(*rate_hz > 0.0)) *rate_hz = fallback_hz;
  };
  settle(imu_, ImuCalibration().rate_hz, &rig_.imu.rate_hz);
  for (size_t i = 0; i < cameras_.size(); ++i) {
    settle(cameras_[i], CameraCalibration().rate_hz, &rig_.cameras[i].rate_hz);
  }
  forEachSensorKind([&](auto kind) {
    auto& sensor = rig_.*kind.calibration;
    if (!sensor) return;
    const double fallback_hz = std::decay_t<decltype(*sensor)>().rate_hz;
    settle(sensors_[kind.section], fallback_hz, &sensor->rate_hz);
  });
}

std::optional<wire::Bytes> BagSource::nextMessage(Cursor* cursor) {
  constexpr size_t kHeaderBytes = 16;
  while (cursor->topic != nullptr && cursor->next < cursor->topic->entries.size()) {
    std::optional<wire::Bytes> message = bag_->read(*cursor->topic, cursor->topic->entries[cursor->next++]);
    if (message && cursor->topic->connection.type == messages::kCompressedVideo.name) {
      try {
        message = compressedImageOfVideo(*message);
      } catch (const wire::Reader::CutOff&) {
        continue;
      }
    }
    if (message && message->size() >= kHeaderBytes) return message;
  }
  return std::nullopt;
}

void BagSource::reportMessage(const Cursor& cursor, const std::string& problem) {
  diagnostics_->report(Severity::Warning, "bag_message",
                       fmt::format("{} {}: the message received at {} ns: {}; passed over",
                                   bag_->file().string(), cursor.topic->connection.topic,
                                   cursor.topic->entries[cursor.next - 1].received.nanoseconds(), problem));
}

std::optional<ImuSample> BagSource::nextOf(Cursor* imu) {
  std::optional<ImuSample> sample = nextReading(imu, messages::parseImu);
  if (sample) restamp(*imu, &*sample);
  return sample;
}

std::optional<ImuSample> BagSource::nextRecordedImu() {
  if (accelerometer_.topic == nullptr) return nextOf(&imu_);
  return halves_.next([this] { return nextOf(&imu_); }, [this] { return nextOf(&accelerometer_); });
}

std::optional<PendingImage> BagSource::nextImage(size_t camera) {
  Cursor& cursor = cameras_[camera];
  std::optional<wire::Bytes> bytes;
  std::string problem;
  while ((bytes = nextMessage(&cursor)) && !messages::checkedReading(*bytes, messages::stampOf, &problem)) {
    reportMessage(cursor, problem);
  }
  if (!bytes) return std::nullopt;
  grey_ranges_.resize(cameras_.size());
  films_.resize(cameras_.size());
  const std::string where = fmt::format("{} {}", bag_->file().string(), cursor.topic->connection.topic);
  if (formOf(*cursor.topic) == messages::ImageForm::Compressed) {
    try {
      if (std::optional<PendingImage> image = films_[camera].next(*bytes, where)) {
        restamp(cursor, &*image);
        return image;
      }
    } catch (const wire::Reader::CutOff&) {
      // Reported when the image is loaded.
    }
  }
  std::optional<GreyRange>& range = grey_ranges_[camera];
  if (!range) range = measureGreyRange(camera);
  PendingImage image = messages::pendingImage(formOf(*cursor.topic), std::move(*bytes), where, *range);
  restamp(cursor, &image);
  return image;
}

GreyRange BagSource::measureGreyRange(size_t camera) {
  const BagTopic& topic = *cameras_[camera].topic;
  const auto range = lodeline::measureGreyRange(topic.entries.size(), [&](size_t i) {
    const std::optional<wire::Bytes> message = bag_->read(topic, topic.entries[i]);
    return message ? messages::storedPixels(formOf(topic), *message) : cv::Mat();
  });
  reportGreyRange(rig_.cameras[camera].name, range, diagnostics_);
  return range.value_or(GreyRange());
}

std::optional<MagnetometerSample> BagSource::nextMagnetometer() {
  Cursor& cursor = cursorOfKind<MagnetometerSample>();
  std::optional<MagnetometerSample> sample = nextReading(&cursor, messages::parseMagneticField);
  if (sample) restamp(cursor, &*sample);
  return sample;
}

std::optional<DepthSample> BagSource::nextDepth() {
  Cursor& cursor = cursorOfKind<DepthSample>();
  const bool is_odometry =
      cursor.topic != nullptr && cursor.topic->connection.type == messages::kOdometry.name;
  std::optional<DepthSample> sample = nextReading(&cursor, [&](std::span<const uint8_t> message) {
    return is_odometry ? messages::parseOdometryDepth(message)
                       : messages::parseFluidPressure(message, rig_file_.water);
  });
  if (sample) restamp(cursor, &*sample);
  return sample;
}

std::optional<SonarSample> BagSource::nextSonar() {
  Cursor& cursor = cursorOfKind<SonarSample>();
  while (echoes_.empty()) {
    const bool is_scan =
        cursor.topic != nullptr && cursor.topic->connection.type == messages::kLaserScan.name;
    const auto echoes = nextReading(&cursor, is_scan ? messages::parseLaserScan : messages::parseRange);
    if (!echoes) return std::nullopt;
    if (echoes->empty()) continue;
    echoes_.assign(echoes->begin(), echoes->end());
    SonarSample first = echoes->front();
    restamp(cursor, &first);
    for (SonarSample& echo : echoes_) echo.time = first.time + (echo.time - echoes->front().time);
  }
  const SonarSample echo = echoes_.front();
  echoes_.pop_front();
  return echo;
}

std::optional<double> BagSource::shareRead() const {
  double sum = 0.0;
  int streams = 0;
  const auto add = [&](const Cursor& cursor) {
    if (cursor.topic == nullptr || cursor.topic->entries.empty()) return;
    sum += static_cast<double>(cursor.next) / static_cast<double>(cursor.topic->entries.size());
    ++streams;
  };
  add(imu_);
  for (const Cursor& camera : cameras_) add(camera);
  if (streams == 0) return std::nullopt;
  return sum / streams;
}

std::unique_ptr<RecordedSource> openBag(const std::filesystem::path& bag, const BagOptions& options,
                                        Diagnostics* diagnostics) {
  return std::make_unique<BagSource>(bag, options, diagnostics);
}

}  // namespace lodeline
