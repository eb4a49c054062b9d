#pragma once

#include <deque>

#include "lodeline/io/csv/plain_csv.h"
#include "lodeline/recording.h"

namespace lodeline {

/// A PlainCsv file as a recording without cameras. It has an uncalibrated gyroscope, accelerometer and, where
/// the file contains one, magnetometer, all in body axes.
class PlainSource : public RecordedSource {
 public:
  /// Throws InputError like PlainCsv, and where gyroscope or accelerometer is missing. `diagnostics` must
  /// outlive the source.
  PlainSource(const std::filesystem::path& file, Diagnostics* diagnostics);

  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t) override { return std::nullopt; }
  std::optional<MagnetometerSample> nextMagnetometer() override;

 private:
  bool readRow();
  void measureRate();

  PlainCsv csv_;
  /// Readings parsed for one sensor while the other one was requested.
  std::deque<ImuSample> imu_;
  std::deque<MagnetometerSample> magnetometer_;
};

}  // namespace lodeline
