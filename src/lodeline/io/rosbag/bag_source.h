#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/images/grey_range.h"
#include "lodeline/io/robots/dvl_screen.h"
#include "lodeline/io/rosbag/checked_reading.h"
#include "lodeline/io/rosbag/container/bag_file.h"
#include "lodeline/io/rosbag/film_topic.h"
#include "lodeline/io/rosbag/imu_content.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/io/rosbag/topic_choice.h"
#include "lodeline/io/streams/imu_halves.h"
#include "lodeline/recording.h"
#include "lodeline/rosbag.h"
#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {

/// A ROS bag of any format as a recording, read as a stream: one message of each topic at a time.
class BagSource : public RecordedSource {
 public:
  /// Throws InputError like openBagFile, readRigFiles and chooseTopics. Also throws it for a rig without
  /// camera or IMU, and for a bag without their readings. Throws UsageError for a topic of a sensor that the
  /// rig does not have. `diagnostics` must outlive the source.
  BagSource(const std::filesystem::path& bag, const BagOptions& options, Diagnostics* diagnostics);

  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<DepthSample> nextDepth() override;
  std::optional<SonarSample> nextSonar() override;
  std::optional<AltimeterSample> nextAltimeter() override;
  std::optional<DvlSample> nextDvl() override;
  std::optional<CurrentSample> nextCurrents() override;

  BagFile& bag() { return *bag_; }
  const RigFile& rigFile() const { return rig_file_; }

 private:
  /// Read position in a topic.
  struct Cursor {
    const BagTopic* topic = nullptr;
    size_t next = 0;
  };

  GreyRange measureGreyRange(size_t camera);
  void refuseUnknownTopics(const BagOptions& options) const;
  void settleCameras(const BagOptions& options);
  void settleRates();
  void settleRobotSensors();
  void checkBeams(const std::vector<Vec3>& stated_D);
  Cursor cursorOf(const std::string& sensor) const;
  template <typename Sample>
  Cursor& cursorOfKind() {
    return sensors_[SensorKind<Sample>::section];
  }
  std::optional<wire::Bytes> nextMessage(Cursor* cursor);
  void reportMessage(const Cursor& cursor, const std::string& problem);
  std::vector<Time> firstStamps(Cursor cursor, const std::string& name);
  /// Assigns a reading the time of the message that was read last.
  template <typename Reading>
  void restamp(const Cursor& cursor, Reading* reading) const {
    if (use_received_times_) reading->time = cursor.topic->entries[cursor.next - 1].received;
  }
  std::optional<ImuSample> nextOf(Cursor* imu);
  /// The next reading of a topic that `parse` can make of a message.
  template <typename Parse>
  auto nextReading(Cursor* cursor, const Parse& parse)
      -> std::optional<decltype(parse(std::span<const uint8_t>()))> {
    while (const std::optional<wire::Bytes> message = nextMessage(cursor)) {
      std::string problem;
      if (auto reading = messages::checkedReading(*message, parse, &problem)) return reading;
      reportMessage(*cursor, problem);
    }
    return std::nullopt;
  }

  std::unique_ptr<BagFile> bag_;
  Diagnostics* diagnostics_;
  RigFile rig_file_;
  bool use_received_times_;
  TopicChoice choice_;
  std::vector<Cursor> cameras_;
  std::vector<FilmTopic> films_;                       ///< per camera, for images that depend on each other
  std::vector<std::optional<GreyRange>> grey_ranges_;  ///< per camera, measured at its first image
  Cursor imu_, accelerometer_;
  std::map<std::string, Cursor> sensors_;  ///< by SensorKind::section
  ImuHalves halves_;                       ///< state for an IMU in two topics
  std::deque<SonarSample> echoes_;         ///< echoes of the scan that was read last
  std::optional<DvlScreen> dvl_screen_;
  bool are_beams_checked_ = false;
};

}  // namespace lodeline
