#pragma once

#include <deque>

#include "lodeline/io/csv/plain_csv.h"
#include "lodeline/io/synchronizer/measurement_source.h"

namespace lodeline {

/// A PlainCsv file as a recording without cameras: gyroscope and accelerometer, and a magnetometer where the
/// file has one, in body axes, uncalibrated.
class PlainSource : public RecordedSource {
 public:
  /// Throws InputError as PlainCsv does, and where gyroscope or accelerometer is missing. `diagnostics` must
  /// outlive the source.
  PlainSource(const std::filesystem::path& file, Diagnostics* diagnostics);

  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t) override { return std::nullopt; }
  std::optional<MagnetometerSample> nextMagnetometer() override;

 private:
  bool readRow();
  void measureRate();

  PlainCsv csv_;
  /// Read for one of the sensors, not yet asked for by the other.
  std::deque<ImuSample> imu_;
  std::deque<MagnetometerSample> magnetometer_;
};

}  // namespace lodeline
