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

/// What became of an attempt to decode an image.
struct LoadedImage {
  cv::Mat image;        ///< 8-bit grey; empty where there was none
  std::string problem;  ///< why `image` is empty, naming the file; empty where all is well
};

/// An image as the recording holds it, for copying without loss.
struct StoredImage {
  std::vector<uint8_t> file;  ///< bytes of an image file; empty where the recording holds bare pixels
  cv::Mat pixels;             ///< those: 8 or 16-bit grey, or 8-bit BGR, BGRA
  std::string problem;        ///< why there is neither
};

/// An image that exists but is decoded only when somebody wants its pixels.
struct PendingImage {
  Time time;         ///< mid-exposure, on the camera's clock
  std::string name;  ///< for messages: the file, or topic and stamp
  /// Decodes. May run on another thread, at the same time as calls to the source; must not throw for damaged
  /// images.
  std::function<LoadedImage()> load;
  /// The same image as it is stored; sources that no recording stands behind have none.
  std::function<StoredImage()> stored = {};
  Time recorded = {};  ///< the stamp as it was stored, whatever is done to `time`; set by the synchronizer
};

/// The same for images that are stored under the same name.
inline uint64_t contentKey(const PendingImage& image) { return std::hash<std::string>()(image.name); }

/// A recording (or a live or simulated rig) as one stream per sensor, each pulled one reading at a time in
/// the order in which it was stored; nothing at a stream's end. Streams of sensors that the rig does not have
/// are empty. Sources neither sort nor repair: the Synchronizer does that, the same for all of them.
class MeasurementSource {
 public:
  virtual ~MeasurementSource() = default;

  /// The sensors, with the cameras in the order in which nextImage() counts them.
  virtual const Rig& rig() const = 0;

  /// Whether readings come as they are measured, so that to read ahead is to wait.
  virtual bool isLive() const { return false; }

  virtual std::optional<ImuSample> nextImu() = 0;
  virtual std::optional<PendingImage> nextImage(size_t camera) = 0;
  virtual std::optional<MagnetometerSample> nextMagnetometer() { return std::nullopt; }
  virtual std::optional<DepthSample> nextDepth() { return std::nullopt; }
  virtual std::optional<SonarSample> nextSonar() { return std::nullopt; }
};

/// A source whose rig was read from files, and may be known better.
class RecordedSource : public MeasurementSource {
 public:
  const Rig& rig() const override { return rig_; }
  /// The next reading, freed from what the calibration says of the IMU's axes.
  std::optional<ImuSample> nextImu() final {
    std::optional<ImuSample> sample = nextRecordedImu();
    if (sample && imu_correction_) sample = imu_correction_->applied(*sample);
    return sample;
  }
  /// The next reading as it was stored.
  virtual std::optional<ImuSample> nextRecordedImu() = 0;
  /// Replaces what the recording's own files say about the magnetometer, before a synchronizer is made.
  void setMagnetometer(const MagnetometerCalibration& magnetometer) { rig_.magnetometer = magnetometer; }
  /// The same of the IMU's noise.
  void setImuNoise(const ImuNoise& noise) { rig_.imu.noise = noise; }

 protected:
  explicit RecordedSource(Rig rig, std::optional<ImuCorrection> imu_correction = std::nullopt)
      : rig_(std::move(rig)), imu_correction_(imu_correction) {}

  Rig rig_;
  /// Nothing where no calibration states it.
  std::optional<ImuCorrection> imu_correction_;
};

}  // namespace lodeline
