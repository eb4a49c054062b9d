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
  /// Images that may wait, per camera. When the estimator does not keep up, the oldest goes. Not below 20,
  /// which rates are measured on.
  size_t max_images = 40;
  /// Readings of every other sensor that may wait.
  size_t max_readings = 100'000;
  /// How much later than inertial readings of the same time the others may come; waiting for them delays a
  /// pose at most so long.
  double patience_s = 0.1;
  /// See RigFile::imu_correction.
  std::optional<ImuCorrection> imu_correction = std::nullopt;
};

/// Sensors at work as a source: whoever hears them pushes readings, from any thread and without ever waiting;
/// the synchronizer pulls, on one other thread, and waits. Readings pushed in time make the same packets as a
/// recording of them would. Where a camera or a slower sensor is silent longer than the patience, the source
/// gives nothing (as at a stream's end) and the packet goes without; what comes after that is dropped and
/// reported as `image_late`, `magnetometer_late`, `depth_late`, what finds no room as `image_dropped`,
/// `imu_dropped` and so on. Without inertial readings and images of the first camera it waits on.
class LiveSource : public RecordedSource {
 public:
  /// `diagnostics`, used while pulling, must outlive the source.
  LiveSource(const Rig& rig, const LiveSourceOptions& options, Diagnostics* diagnostics);

  void push(const ImuSample& sample);
  void push(const MagnetometerSample& sample);
  void push(const DepthSample& sample);
  /// `camera`: its place in the rig.
  void push(size_t camera, PendingImage image);
  /// No more is to come: what waits is still given, then nothing.
  void close();

  /// Waits for some readings of the IMU and of every camera, and settles the rig's rates by them as
  /// settleRate() does. To be called before a synchronizer is made. False where it was closed before that.
  bool settleRates();
  /// Sensors that settleRates() is still waiting for, by name.
  std::vector<std::string> unheard() const;
  /// Images of the first camera that wait.
  size_t backlog() const;

  bool isLive() const override { return true; }
  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<DepthSample> nextDepth() override;

 private:
  /// Readings that could not be used.
  struct Loss {
    int count = 0;
    Time first;
  };
  template <typename Reading>
  struct Inbox {
    std::string kind, name;  ///< as in StreamExpectation
    size_t limit = 0;
    Duration offset_to_imu_clock;
    size_t heard = 0;  ///< since the beginning
    std::deque<Reading> waiting;
    std::optional<Time> given;    ///< last one
    std::optional<Time> settled;  ///< packets up to here go without what was not there, IMU clock
    Loss overflow, late;
  };

  template <typename Reading>
  void put(Inbox<Reading>* inbox, Reading reading);
  /// `waits_on`: however long it takes.
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
  std::optional<Time> newest_image_;  ///< given out of the first camera's, on the IMU's clock
  bool image_follows_ = false;        ///< a further image is asked for only to see what follows
};

}  // namespace lodeline
