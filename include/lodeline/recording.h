#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

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

/// An image in memory, for LiveSource::push(): 8 or 16-bit pixels, grey or BGR. `time`: mid-exposure, on the
/// camera's clock. The pixels must not change until the image has been processed.
PendingImage imageInMemory(Time time, const cv::Mat& pixels);

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

  /// Whether the source is live: reading ahead then waits for the sensors.
  virtual bool isLive() const { return false; }

  virtual std::optional<ImuSample> nextImu() = 0;
  virtual std::optional<PendingImage> nextImage(size_t camera) = 0;
  virtual std::optional<MagnetometerSample> nextMagnetometer() { return std::nullopt; }
  virtual std::optional<DepthSample> nextDepth() { return std::nullopt; }
  virtual std::optional<SonarSample> nextSonar() { return std::nullopt; }
  virtual std::optional<AltimeterSample> nextAltimeter() { return std::nullopt; }
  virtual std::optional<DvlSample> nextDvl() { return std::nullopt; }
  virtual std::optional<CurrentSample> nextCurrents() { return std::nullopt; }
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
  /// The correction that nextImu() applies.
  const std::optional<ImuCorrection>& imuCorrection() const { return imu_correction_; }
  /// Share of the inertial readings and images that were read, 0 to 1, as the mean over their streams;
  /// nothing where their number is unknown.
  virtual std::optional<double> shareRead() const { return std::nullopt; }
  /// The next reading as stored.
  virtual std::optional<ImuSample> nextRecordedImu() = 0;
  /// Replaces the recording's own magnetometer calibration; call it before creating a synchronizer.
  void setMagnetometer(const MagnetometerCalibration& magnetometer) { rig_.magnetometer = magnetometer; }
  /// Replaces the recording's own IMU noise; call it before creating a synchronizer.
  void setImuNoise(const ImuNoise& noise) { rig_.imu.noise = noise; }

 protected:
  explicit RecordedSource(Rig rig, std::optional<ImuCorrection> imu_correction = std::nullopt)
      : rig_(std::move(rig)), imu_correction_(std::move(imu_correction)) {}

  Rig rig_;
  /// Correction of the IMU's axes; nothing where no calibration states it.
  std::optional<ImuCorrection> imu_correction_;
};

struct LiveSourceOptions {
  /// Capacity of the image queue per camera. When the estimator is too slow, the oldest image is dropped. At
  /// least 20, because rates are measured on the queued images.
  size_t max_images = 40;
  /// Capacity of the queue of every other sensor, in readings.
  size_t max_readings = 100'000;
  /// Maximum delay of other sensors relative to inertial readings of the same time, s. Waiting for them
  /// delays a pose by at most this time.
  double patience_s = 0.1;
  /// See RigFile::imu_correction.
  std::optional<ImuCorrection> imu_correction = std::nullopt;
};

/// Live sensors as a source. Any thread can push readings without waiting; one other thread, the
/// synchronizer's, pulls and waits. Readings pushed in time give the same packets as a recording of them.
/// Where a camera or a slower sensor is silent longer than `patience_s`, the source returns nothing, as
/// at a stream's end. The packet then has no reading of it. Later readings of that time are dropped and
/// reported as `image_late`, `magnetometer_late`, `depth_late`. Readings that exceed the capacity are
/// reported as `image_dropped`, `imu_dropped` and so on. For inertial readings and images of the first
/// camera, it waits without limit.
class LiveSource : public RecordedSource {
 public:
  /// `diagnostics`, used while pulling, must outlive the source.
  LiveSource(const Rig& rig, const LiveSourceOptions& options, Diagnostics* diagnostics);

  void push(const ImuSample& sample);
  void push(const MagnetometerSample& sample);
  void push(const DepthSample& sample);
  void push(const SonarSample& sample);
  void push(const AltimeterSample& sample);
  void push(const DvlSample& sample);
  void push(const CurrentSample& sample);
  /// `camera`: index in the rig.
  void push(size_t camera, PendingImage image);
  /// Ends the streams: queued readings are still returned, then nothing.
  void close();

  /// Waits for some readings of the IMU and of every camera, and sets the rig's rates from them with
  /// settleRate(). Call it before creating a synchronizer. Returns false where the source was closed before
  /// that.
  bool settleRates();
  /// Names of the sensors for which settleRates() is still waiting.
  std::vector<std::string> unheard() const;
  /// Number of queued images of the first camera.
  size_t backlog() const;

  bool isLive() const override { return true; }
  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<DepthSample> nextDepth() override;
  std::optional<SonarSample> nextSonar() override;
  std::optional<AltimeterSample> nextAltimeter() override;
  std::optional<DvlSample> nextDvl() override;
  std::optional<CurrentSample> nextCurrents() override;

 private:
  /// Count of readings that could not be used.
  struct Loss {
    int count = 0;
    Time first;
  };
  template <typename Reading>
  struct Inbox {
    std::string kind, name;  ///< as in StreamExpectation
    size_t limit = 0;
    Duration offset_to_imu_clock;
    size_t heard = 0;  ///< number of readings since the start
    std::deque<Reading> waiting;
    std::optional<Time> given;    ///< time of the last reading returned
    std::optional<Time> settled;  ///< end of the completed packets, IMU clock
    Loss overflow, late;
  };

  template <typename Reading>
  void put(Inbox<Reading>* inbox, Reading reading);
  /// `waits_on`: wait without limit.
  template <typename Reading>
  std::optional<Reading> take(Inbox<Reading>* inbox, bool waits_on);
  template <typename Reading>
  void settleRate(const Inbox<Reading>& inbox, double fallback_hz, double* rate_hz);
  template <typename Reading>
  void reportLosses(Inbox<Reading>* inbox);
  bool patienceIsOver() const;
  bool isHeard() const;

  LiveSourceOptions options_;
  Diagnostics* diagnostics_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  Inbox<ImuSample> imu_;
  std::vector<Inbox<PendingImage>> cameras_;
  Inbox<MagnetometerSample> magnetometer_;
  Inbox<DepthSample> depth_;
  Inbox<SonarSample> sonar_;
  Inbox<AltimeterSample> altimeter_;
  Inbox<DvlSample> dvl_;
  Inbox<CurrentSample> currents_;
  std::optional<Time> newest_imu_;
  std::optional<Time> newest_image_;  ///< latest image of the first camera that was returned, IMU clock
  bool image_follows_ = false;        ///< whether the next image is requested only to look ahead
};

/// Parts of an EuRoC ASL recording to read. The defaults fit trajectory estimation. Tools that use only
/// inertial or magnetic readings can open recordings that contain nothing else.
struct EurocOptions {
  /// Numbers N of the camN folders to use; the first one is the reference. Empty for all cameras.
  std::vector<int> camera_indices;
  /// False ignores the cameras of the recording.
  bool with_cameras = true;
  /// False accepts a recording without cameras. Where images are missing, it accepts the bare image lists.
  bool needs_cameras = true;
  /// False accepts a recording without `imu0`; EuRoC's body is then the body frame.
  bool needs_imu = true;
  /// False gives sensors without a calibration file the default calibration, with a warning. Such a camera
  /// has no size and cannot project.
  bool needs_calibration = true;
  /// Files that describe the rig (see readRigFiles); they have priority over those in the recording.
  std::vector<std::filesystem::path> rig_files = {};
};

/// Opens a recording in the EuRoC ASL layout; `data`: the folder that contains mav0, or mav0 itself. Throws
/// InputError where it is no recording or lacks what `options` require. `diagnostics` must outlive the
/// source.
std::unique_ptr<RecordedSource> openEuroc(const std::filesystem::path& data, const EurocOptions& options,
                                          Diagnostics* diagnostics);

}  // namespace lodeline
