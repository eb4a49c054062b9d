#pragma once

#include <deque>
#include <future>
#include <optional>
#include <vector>

#include "lodeline/io/streams/inertial_screen.h"
#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/io/synchronizer/image_repeats.h"
#include "lodeline/io/synchronizer/imu_interval.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct SynchronizerOptions {
  /// An image of another camera belongs to the nearest one of the first camera, at most this far from it and
  /// never more than half a frame period. Each image counts at its own time (FramePacket::image_delays_s).
  double match_tolerance_s = 0.05;
  /// Silence of the IMU and the slower sensors is reported beyond this many nominal periods.
  double max_gap_periods = 4.0;
  /// The same for images, where one lost frame is worth a word.
  double max_image_gap_periods = 1.5;
  /// Readings kept from before the first image.
  double history_s = 10.0;
  /// Leaves out the images of the first so many seconds.
  double skip_s = 0.0;
  /// Ends so many seconds after the first image used; 0 for the whole recording.
  double duration_s = 0.0;
  /// Decodes the next packet's images on threads of their own while the caller works on this one. The
  /// packets are the same either way.
  bool prefetch = true;
  /// Added to the stamps of each camera's images besides what the calibration says; empty for none.
  std::vector<double> image_offset_s = {};
  /// How inertial readings are screened.
  InertialScreenOptions inertial;
};

/// Turns a source's separate streams into one packet per image of the first camera. A packet is given out
/// only when inertial readings at or past the image time are there, and magnetometer readings past it (or
/// their stream has ended). Reports into `diagnostics`, each with its stamp: images without inertial data
/// (dropped), images without a partner, missing and damaged images (an empty cv::Mat in the packet), and
/// gaps, duplicates and disorder of every stream. Images that repeat the one before (ImageRepeats) are left
/// out; where the first camera's does, the packet's readings go to the packet after it, unless the camera is
/// frozen. Memory does not grow with the length of the recording.
class Synchronizer {
 public:
  /// `source` and `diagnostics` must outlive the synchronizer.
  Synchronizer(MeasurementSource* source, const SynchronizerOptions& options, Diagnostics* diagnostics);

  /// The next packet; nothing at the end. Images of another size than the calibration says are left out and
  /// reported; throws InputError where all of a camera's are.
  std::optional<FramePacket> next();

  /// Images of the first camera that the recording holds within the part that is used, so far; also those
  /// that could not be used.
  int64_t recordedImages() const { return recorded_images_; }

  /// Moves the images that are still to come by so much, as their clock was found to be off.
  void moveImages(Duration by);
  /// From the next images on, a secondary camera (1, 2, ...) counts as taking them so much later.
  void delayCamera(size_t camera, double by_s);

  /// Readings and images held at present, for tests of its boundedness.
  size_t bufferedReadings() const;

 private:
  /// A packet whose images are still to be decoded.
  struct Draft {
    FramePacket packet;
    std::vector<std::optional<PendingImage>> pending;
    std::vector<std::future<LoadedImage>> decoding;
  };

  StreamExpectation expectation(const char* kind, const std::string& name, double rate_hz) const;
  StreamExpectation magnetometerExpectation() const;
  OrderedStream<PendingImage> imageStream(size_t camera);
  std::optional<Draft> draftNext();
  void followClocks(PendingImage* reference);
  bool followImageClock(Duration step, PendingImage* reference);
  bool followCommonClock(const ImuIntervals::Gap& gap, Duration step, PendingImage* reference);
  bool followImuClock(const ImuIntervals::Gap& gap, const PendingImage& reference);
  void reportApart();
  bool coveredByImu(const PendingImage& image);
  std::optional<PendingImage> partnerOf(const PendingImage& reference, size_t camera);
  double delay_s(const PendingImage& reference, const PendingImage& partner, size_t camera);
  std::optional<FramePacket> nextOfImage();
  void startDecoding(Draft* draft) const;
  FramePacket finish(Draft draft);
  void storeImage(size_t camera, const PendingImage& pending, LoadedImage loaded, FramePacket* packet);
  void checkSizes() const;

  /// Images of one camera by their size, and how much later than the first camera's they came lately.
  struct CameraHistory {
    int right_size = 0, other_size = 0;
    std::string size_problem;
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
  OrderedStream<MagnetometerSample> magnetometer_;
  OrderedStream<DepthSample> depth_;
  OrderedStream<SonarSample> sonar_;
  std::optional<Time> first_image_time_;
  std::optional<Time> last_image_time_;
  int64_t recorded_images_ = 0;
  SpanOfStream images_span_, magnetometer_span_, depth_span_, sonar_span_;
  std::optional<Time> last_packet_time_;
  std::optional<Draft> prefetched_;
  bool started_ = false;
};

}  // namespace lodeline
