#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

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
/// Where a camera or a slower sensor is silent longer than `patience_s`, the source returns nothing (as at a
/// stream's end), and the packet has no reading of it. Later readings of that time are dropped and reported
/// as `image_late`, `magnetometer_late`, `depth_late`. Readings that exceed the capacity are reported as
/// `image_dropped`, `imu_dropped` and so on. For inertial readings and images of the first camera, it waits
/// without limit.
class LiveSource : public RecordedSource {
 public:
  /// `diagnostics`, used while pulling, must outlive the source.
  LiveSource(const Rig& rig, const LiveSourceOptions& options, Diagnostics* diagnostics);

  void push(const ImuSample& sample);
  void push(const MagnetometerSample& sample);
  void push(const DepthSample& sample);
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
  std::optional<Time> newest_imu_;
  std::optional<Time> newest_image_;  ///< latest image of the first camera that was returned, IMU clock
  bool image_follows_ = false;        ///< whether the next image is requested only to look ahead
};

}  // namespace lodeline
