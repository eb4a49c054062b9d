#pragma once

#include <cstddef>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/sensors/imu_correction.h"
#include "lodeline/sensors/measurements.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Result of decoding an image.
struct LoadedImage {
  cv::Mat image;        ///< 8-bit grey; empty where there was none
  std::string problem;  ///< reason why `image` is empty, naming the file; empty on success
};

/// An image as stored in the recording, for copying without loss.
struct StoredImage {
  std::vector<uint8_t> file;  ///< bytes of an image file; empty where the recording stores raw pixels
  cv::Mat pixels;             ///< raw pixels: 8 or 16-bit grey, or 8-bit BGR, BGRA
  std::string problem;        ///< reason why both are missing
};

/// An image that is decoded on demand.
struct PendingImage {
  Time time;         ///< mid-exposure, on the camera's clock
  std::string name;  ///< for messages: the file, or topic and stamp
  /// Decodes the image. May run on another thread in parallel with calls to the source; must not throw for
  /// damaged images.
  std::function<LoadedImage()> load;
  /// Returns the image as stored; empty for sources without a recording.
  std::function<StoredImage()> stored = {};
  Time recorded = {};  ///< the stored stamp, unaffected by changes of `time`; set by the synchronizer
};

/// Hash that is equal for images stored under the same name.
inline uint64_t contentKey(const PendingImage& image) { return std::hash<std::string>()(image.name); }

/// A recording (or a live or simulated rig) as one stream per sensor. Each call returns one reading in stored
/// order, and nothing at the end of a stream. Streams of missing sensors are empty. Sources neither sort nor
/// repair; the Synchronizer does that for all of them.
class MeasurementSource {
 public:
  virtual ~MeasurementSource() = default;

  /// The sensors, with the cameras in the order of the index of nextImage().
  virtual const Rig& rig() const = 0;

  /// Whether readings arrive as they are measured, so that reading in advance means waiting.
  virtual bool isLive() const { return false; }

  virtual std::optional<ImuSample> nextImu() = 0;
  virtual std::optional<PendingImage> nextImage(size_t camera) = 0;
  virtual std::optional<MagnetometerSample> nextMagnetometer() { return std::nullopt; }
  virtual std::optional<DepthSample> nextDepth() { return std::nullopt; }
  virtual std::optional<SonarSample> nextSonar() { return std::nullopt; }
};

/// A source whose rig was read from files and can be replaced in parts.
class RecordedSource : public MeasurementSource {
 public:
  const Rig& rig() const override { return rig_; }
  /// The next reading, corrected with the calibration of the IMU's axes.
  std::optional<ImuSample> nextImu() final {
    std::optional<ImuSample> sample = nextRecordedImu();
    if (sample && imu_correction_) sample = imu_correction_->applied(*sample);
    return sample;
  }
  /// The next reading as stored.
  virtual std::optional<ImuSample> nextRecordedImu() = 0;
  /// Replaces the recording's own magnetometer calibration; call it before creating a synchronizer.
  void setMagnetometer(const MagnetometerCalibration& magnetometer) { rig_.magnetometer = magnetometer; }
  /// Replaces the recording's own IMU noise; call it before creating a synchronizer.
  void setImuNoise(const ImuNoise& noise) { rig_.imu.noise = noise; }

 protected:
  explicit RecordedSource(Rig rig, std::optional<ImuCorrection> imu_correction = std::nullopt)
      : rig_(std::move(rig)), imu_correction_(imu_correction) {}

  Rig rig_;
  /// Correction of the IMU's axes; nothing where no calibration states it.
  std::optional<ImuCorrection> imu_correction_;
};

}  // namespace lodeline
