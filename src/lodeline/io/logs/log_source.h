#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "lodeline/io/logs/readings/sensor_log.h"
#include "lodeline/io/streams/imu_halves.h"
#include "lodeline/recording.h"

namespace lodeline {

/// A sensor log as a recording without cameras. It has an uncalibrated gyroscope, accelerometer and, where
/// the log contains one, magnetometer, all in body axes, and the currents of an autopilot. Where gyroscope
/// and accelerometer have separate times, the specific force is interpolated at those of the gyroscope.
class LogSource : public RecordedSource {
 public:
  /// Throws InputError like openSensorLog, and where gyroscope or accelerometer is missing. `diagnostics`
  /// must outlive the source.
  LogSource(const std::filesystem::path& file, Diagnostics* diagnostics);

  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t) override { return std::nullopt; }
  std::optional<MagnetometerSample> nextMagnetometer() override;
  /// Currents at the times of the channel with the most readings; the others keep their last reading.
  std::optional<CurrentSample> nextCurrents() override;

 private:
  bool readOne();
  void takeCurrents(const LogReading& reading);
  void measureRates();
  /// The next of these readings; reads on until there is one.
  std::optional<ImuSample> takeHalf(std::deque<ImuSample>* readings);

  std::unique_ptr<SensorLog> log_;
  ImuHalves halves_;
  /// Readings that were read while another sensor was requested.
  std::deque<ImuSample> imu_, gyroscope_, accelerometer_;
  std::deque<MagnetometerSample> magnetometer_;
  std::deque<CurrentSample> currents_;
  std::vector<std::optional<double>> last_currents_A_;  ///< by channel
};

}  // namespace lodeline
