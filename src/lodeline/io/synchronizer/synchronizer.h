#pragma once

#include <deque>
#include <future>
#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/inertial_screen.h"
#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/io/synchronizer/image_repeats.h"
#include "lodeline/io/synchronizer/imu_interval.h"
#include "lodeline/io/synchronizer/sensor_streams.h"
#include "lodeline/recording.h"

namespace lodeline {

struct SynchronizerOptions {
  /// Maximum time between an image of another camera and the nearest image of the first camera, s; never more
  /// than half a frame period. Each image keeps its own time (FramePacket::image_delays_s).
  double match_tolerance_s = 0.05;
  /// Pause of the IMU and the slower sensors that is reported, in nominal periods.
  double max_gap_periods = 4.0;
  /// Pause of the images that is reported, in nominal periods; a single lost frame is reported too.
  double max_image_gap_periods = 1.5;
  /// Length of the readings kept from before the first image, s.
  double history_s = 10.0;
  /// Leaves out the images of the first `skip_s` seconds.
  double skip_s = 0.0;
  /// Ends `duration_s` seconds after the first image used; 0 for the whole recording.
  double duration_s = 0.0;
  /// Decodes the next packet's images on separate threads while the caller processes the current one. The
  /// packets are the same with and without it.
  bool prefetch = true;
  /// Added to the stamps of each camera's images in addition to the calibration; empty for none.
  std::vector<double> image_offset_s = {};
  /// Options of the inertial screen.
  InertialScreenOptions inertial;
};

/// Combines the separate streams of a source into one packet per image of the first camera. A packet needs
/// inertial readings at or after the image time and magnetometer readings after it, or the end of their
/// stream.
///
/// It reports, each with a stamp: images without inertial data (dropped) or without a partner, missing and
/// damaged images (an empty cv::Mat), gaps, duplicates and disorder of every stream. Images that repeat the
/// one before are left out (ImageRepeats). Where an image of the first camera is a repeat, the next packet
/// gets the readings, unless the camera is frozen. Memory use does not depend on the length of the recording.
class Synchronizer {
 public:
  /// `source` and `diagnostics` must outlive the synchronizer.
  Synchronizer(MeasurementSource* source, const SynchronizerOptions& options, Diagnostics* diagnostics);

  /// The next packet; nothing at the end. Images whose size differs from the calibration are left out and
  /// reported. Throws InputError where all images of a camera have another size.
  std::optional<FramePacket> next();

  /// Number of images of the first camera so far within the used part of the recording, including unusable
  /// ones.
  int64_t recordedImages() const { return recorded_images_; }

  /// Shifts the images that follow, because their clock was found to have an offset.
  void moveImages(Duration by);
  /// From the next images on, adds `by_s` to the delay of a secondary camera (1, 2, ...).
  void delayCamera(size_t camera, double by_s);

  /// Number of readings and images held at present, for tests of the memory bound.
  size_t bufferedReadings() const;

 private:
  /// A packet whose images are not decoded yet.
  struct Draft {
    FramePacket packet;
    std::vector<std::optional<PendingImage>> pending;
    std::vector<std::future<LoadedImage>> decoding;
  };

  StreamExpectation expectation(const char* kind, const std::string& name, double rate_hz) const;
  OrderedStream<PendingImage> imageStream(size_t camera);
  std::optional<Draft> draftNext();
  void followClocks(PendingImage* reference);
  bool followImageClock(Duration step, PendingImage* reference);
  bool followCommonClock(const ImuIntervals::Gap& gap, Duration step, PendingImage* reference);
  bool followImuClock(const ImuIntervals::Gap& gap, const PendingImage& reference);
  void reportApart(bool may_read_on);
  void reportUnpaired(size_t camera, bool may_read_on);
  bool coveredByImu(const PendingImage& image);
  std::optional<PendingImage> partnerOf(const PendingImage& reference, size_t camera);
  double delay_s(const PendingImage& reference, const PendingImage& partner, size_t camera);
  std::optional<FramePacket> nextOfImage();
  void startDecoding(Draft* draft) const;
  FramePacket finish(Draft draft);
  void storeImage(size_t camera, const PendingImage& pending, LoadedImage loaded, FramePacket* packet);
  void checkSizes() const;

  /// Per camera: counts of images by size, the times of its images, how many are partners of the first
  /// camera's, and recent delays relative to these.
  struct CameraHistory {
    int right_size = 0, other_size = 0;
    std::string size_problem;
    SpanOfStream span;
    int64_t partners = 0;
    std::deque<double> delays_s;
  };

  ImuIntervals::Pull inertialReadings() const;

  MeasurementSource* source_;
  SynchronizerOptions options_;
  Diagnostics* diagnostics_;
  ImuIntervals imu_;
  std::vector<OrderedStream<PendingImage>> cameras_;
  std::vector<CameraHistory> histories_;
  ImageRepeats repeats_;
  SensorStreams sensors_;
  std::optional<Time> first_image_time_;
  std::optional<Time> last_image_time_;
  int64_t recorded_images_ = 0;
  SpanOfStream images_span_;
  std::optional<Time> last_packet_time_;
  std::optional<Draft> prefetched_;
  bool started_ = false;
};

}  // namespace lodeline
