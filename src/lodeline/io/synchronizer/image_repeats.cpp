#include "lodeline/io/synchronizer/image_repeats.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/io/synchronizer/sparse_difference.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kShortestRest_s = 0.3;
/// Pause of the first camera after which poses without images are computed and a finding is reported.
constexpr double kFrozen_s = 0.25;

/// Options of the stationary detector: deviations of five sigmas of white noise in addition to a rig's own
/// vibration.
RestDetectorOptions restOptions(const ImuCalibration& imu) {
  constexpr double kSigmas = 5.0;
  const double per_density = kSigmas * std::sqrt(imu.rate_hz);
  RestDetectorOptions options;
  options.shortest_s = kShortestRest_s;
  options.rate_deviation_rad_per_s = 0.02 + per_density * imu.noise.gyroscope_density_rad_per_s_sqrtHz;
  options.force_deviation_m_per_s2 = 0.1 + per_density * imu.noise.accelerometer_density_m_per_s2_sqrtHz;
  return options;
}

bool areEqual(const cv::Mat& a, const cv::Mat& b) {
  const auto bytes = static_cast<size_t>(a.cols);
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr<uint8_t>(row), b.ptr<uint8_t>(row), bytes) != 0) return false;
  }
  return true;
}

bool isBlank(const cv::Mat& image) {
  const uint8_t grey = image.at<uint8_t>(0, 0);
  for (int row = 0; row < image.rows; ++row) {
    const uint8_t* p = image.ptr<uint8_t>(row);
    if (!std::all_of(p, p + image.cols, [grey](uint8_t value) { return value == grey; })) return false;
  }
  return true;
}

/// Time after the first image, formatted as "1:02.350".
std::string clockTime(Duration since_start) {
  const int64_t ms = (since_start.nanoseconds() + 500'000) / 1'000'000;
  return fmt::format("{}:{:02}.{:03}", ms / 60'000, ms / 1000 % 60, ms % 1000);
}

}  // namespace

ImageRepeats::ImageRepeats(const Rig& rig, Diagnostics* diagnostics)
    : rest_(restOptions(rig.imu)), diagnostics_(diagnostics) {
  for (const CameraCalibration& camera : rig.cameras) {
    View view;
    view.name = camera.name;
    view.camera_from_body = camera.body_from_camera.rotation.conjugate().toRotationMatrix();
    view.focal_px = focalLengthOnAxis_px(camera);
    views_.push_back(std::move(view));
  }
}

void ImageRepeats::follow(const FramePacket& packet) {
  Vec3 turn_B = Vec3::Zero();
  for (const ImuSample& sample : packet.imu) {
    const double step_s = last_reading_ ? (sample.time - *last_reading_).seconds() : 0.0;
    if (last_reading_ && step_s <= 0.0) continue;
    last_reading_ = sample.time;
    turn_B += step_s * sample.angular_velocity_B;
    if (!rest_.update(sample, step_s)) {
      rests_since_.reset();
    } else if (!rests_since_) {
      rests_since_ = sample.time - Duration::fromSeconds(kShortestRest_s);
    }
  }
  for (View& view : views_) view.turn_B += turn_B;
}

bool ImageRepeats::isRepeat(const cv::Mat& image, View* view) const {
  constexpr double kShare = 0.2, kLeastUsual_grey = 1.5, kLeastTurn_px = 2.5;
  constexpr size_t kUsual = 5;
  constexpr int kProved = 3;
  const double difference = sparseDifference(image, view->newest);
  if (difference == 0.0 && areEqual(image, view->newest)) return true;
  if (view->differences.size() >= kUsual) {
    const double usual = median(std::vector<double>(view->differences.begin(), view->differences.end()));
    const double turn_px = view->focal_px * (view->camera_from_body * view->turn_B).head<2>().norm();
    const bool is_near = usual > kLeastUsual_grey && difference < kShare * usual;
    if (is_near && turn_px > kLeastTurn_px) ++view->near_repeats;
    if (is_near && (turn_px > kLeastTurn_px || view->near_repeats >= kProved)) return true;
  }
  view->differences.push_back(difference);
  if (view->differences.size() > kUsual) view->differences.pop_front();
  return false;
}

bool ImageRepeats::isResting(const View& view) const {
  constexpr double kBefore_s = 0.7, kAfter_s = 0.5;
  if (!rests_since_) return false;
  if (!view.ever_changed) return true;
  // If a camera freezes while the rig glides, the readings are at rest before; if it freezes during a
  // rotation, they are not at rest for a while after.
  const double earlier_s = (view.newest_time - *rests_since_).seconds();
  return earlier_s < kBefore_s && earlier_s > -kAfter_s;
}

ImageRepeats::Reference ImageRepeats::screen(FramePacket* packet) {
  if (!first_time_) first_time_ = packet->time;
  follow(*packet);
  Reference reference = Reference::New;
  for (size_t i = 0; i < views_.size(); ++i) {
    View& view = views_[i];
    cv::Mat& image = packet->images[i];
    if (image.empty()) continue;
    const bool is_repeat =
        !view.newest.empty() && image.size() == view.newest.size() && isRepeat(image, &view);
    if (!is_repeat) {
      close(&view);
      view.ever_changed = !view.newest.empty();
      view.newest = image;
      view.newest_time = packet->time;
      view.turn_B.setZero();
      continue;
    }
    if (isResting(view)) {
      view.run = {};
      continue;
    }
    if (view.run.images++ == 0) {
      view.run.first = packet->time;
      view.run.first_stamp = packet->image_stamp;
      view.run.is_blank = isBlank(image);
    }
    view.run.last = packet->time;
    // A blank image has no features to track, but its moment still gets a pose.
    if (view.run.is_blank) continue;
    image.release();
    if (i > 0) continue;
    const bool is_frozen = (packet->time - view.newest_time).seconds() > kFrozen_s;
    reference = is_frozen ? Reference::Frozen : Reference::Repeat;
  }
  return reference;
}

void ImageRepeats::close(View* view) {
  const Run run = std::exchange(view->run, {});
  if (run.images == 0) return;
  const std::string from = clockTime(run.first - *first_time_), to = clockTime(run.last - *first_time_);
  if (run.is_blank) {
    diagnostics_->report(
        Severity::Warning, "images_blank",
        fmt::format("{}: {} images from {} to {} (stamp {} ns on) are one grey level throughout: a closed "
                    "shutter, no light, or a camera that fails; nothing can be followed in them",
                    view->name, run.images, from, to, run.first_stamp.nanoseconds()));
  } else if ((run.last - view->newest_time).seconds() > kFrozen_s) {
    diagnostics_->report(
        Severity::Warning, "images_frozen",
        fmt::format("{}: frozen from {} to {} (stamp {} ns on): {} images repeat the one before; left out, "
                    "that time is bridged without them. The camera or its driver hangs",
                    view->name, from, to, run.first_stamp.nanoseconds(), run.images));
  } else {
    diagnostics_->report(
        Severity::Warning, "images_repeated",
        fmt::format("{}: the image at {} (stamp {} ns) repeats the one before under another stamp; left "
                    "out. A driver or converter that fills up its frame rate does so: record at the rate of "
                    "the camera",
                    view->name, from, run.first_stamp.nanoseconds()));
  }
}

void ImageRepeats::finish() {
  for (View& view : views_) close(&view);
}

}  // namespace lodeline
