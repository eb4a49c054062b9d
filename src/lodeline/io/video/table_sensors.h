#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lodeline/io/csv/plain_csv.h"
#include "lodeline/io/streams/imu_halves.h"
#include "lodeline/io/video/axis_table.h"
#include "lodeline/io/video/video_folder.h"
#include "lodeline/io/video/video_sensors.h"

namespace lodeline {

/// The readings of a phone from the tables beside its film, on the clock of their stamps, which is that of
/// the images. A gyroscope and an accelerometer in two tables are united at the times of the gyroscope. Axes
/// are those of the phone: x right, y up, z out of the screen.
class TableSensors : public VideoSensors {
 public:
  /// Throws InputError where a table cannot be read. `diagnostics` must outlive the object.
  TableSensors(const VideoFolder& folder, Diagnostics* diagnostics);

  bool hasImu() const override { return true; }
  bool hasMagnetometer() const override { return magnetometer_.has_value(); }
  std::optional<ImuSample> nextImu() override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::vector<Time> firstImuStamps() const override { return imu_stamps_; }
  std::vector<Time> firstMagnetometerStamps() const override { return magnetometer_stamps_; }
  const std::vector<VideoStreamFacts>& facts() const override { return facts_; }

 private:
  void addFacts(const char* key, const std::filesystem::path& file, const std::vector<Time>& stamps);

  std::optional<PlainCsv> both_;
  std::optional<AxisTable> gyroscope_, accelerometer_, magnetometer_;
  ImuHalves halves_;
  std::vector<Time> imu_stamps_, magnetometer_stamps_;
  std::vector<VideoStreamFacts> facts_;
};

}  // namespace lodeline
