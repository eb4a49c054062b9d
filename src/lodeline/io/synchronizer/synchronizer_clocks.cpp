#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/io/synchronizer/synchronizer.h"

/// Corrections of the synchronizer for a clock that jumped ahead within a recording. A clock that was set
/// back is detected in its own stream (OrderedStream). A clock that was set ahead looks like lost data until
/// the streams are compared.
namespace lodeline {
namespace {

/// Minimum jump; a shorter pause counts as lost data or a break, whose uncertainty the readings across it
/// include.
constexpr double kLeastJump_s = 1.0;
/// Maximum break of one sensor while the other one continues.
constexpr double kLongestPause_s = 10.0;
/// Length to which a longer pause of all sensors is shortened.
constexpr double kBridgedPause_s = 1.0;

Duration seconds(double s) { return Duration::fromSeconds(s); }

}  // namespace

/// Subtracts clock jumps between the previous image and `reference` from the later stamps.
void Synchronizer::followClocks(PendingImage* reference) {
  const Duration step = span(reference->time, *last_image_time_);
  // A stamp far in the future must not cause the whole recording to be read into memory.
  constexpr double kHorizon_s = 3600.0;
  const Time horizon = std::min(reference->time, *last_image_time_ + seconds(kHorizon_s));
  imu_.readUntil(horizon);
  const std::optional<ImuIntervals::Gap> gap = imu_.longestGap(*last_image_time_, horizon);
  if (step.seconds() > std::max(kLeastJump_s, 3.0 / source_->rig().cameras[0].rate_hz)) {
    if (gap && followCommonClock(*gap, step, reference)) return;
    if (followImageClock(step, reference)) return;
  }
  if (gap && gap->length().seconds() > kLeastJump_s) followImuClock(*gap, *reference);
}

/// Handles an equally long pause of all sensors: a clock set ahead, or an interrupted recording.
bool Synchronizer::followCommonClock(const ImuIntervals::Gap& gap, Duration step, PendingImage* reference) {
  const double period_s = 1.0 / source_->rig().cameras[0].rate_hz;
  if (std::abs(gap.length().seconds() - step.seconds()) > 2.0 * period_s) return false;
  if (gap.length().seconds() <= kLongestPause_s) return true;  // included in the uncertainty across the pause
  const Duration by = seconds(kBridgedPause_s) - gap.length();
  const Time from = gap.begin + seconds(0.5 * gap.length().seconds());
  diagnostics_->report(
      Severity::Serious, "clock_jump",
      fmt::format("all sensors: nothing for {:.6g} s after stamp {} ns: the clock was set ahead, or the "
                  "recording was interrupted. It goes on as after a pause of {:g} s; if the rig moved "
                  "meanwhile, the two parts do not belong together",
                  gap.length().seconds(), gap.begin.nanoseconds(), kBridgedPause_s));
  reference->time = moved(reference->time, by);
  imu_.shiftFrom(from, by);
  for (OrderedStream<PendingImage>& camera : cameras_) camera.shiftFrom(from, by);
  sensors_.shiftFrom(from, by);
  return true;
}

/// Handles images that jump to a time after all inertial readings, or by more than a camera's pause.
bool Synchronizer::followImageClock(Duration step, PendingImage* reference) {
  constexpr double kLongestSilence_s = 3600.0;
  const bool is_covered = imu_.last() && *imu_.last() >= reference->time;
  if (is_covered && step.seconds() < kLongestSilence_s) return false;
  if (source_->isLive()) return false;
  const Duration period = seconds(1.0 / source_->rig().cameras[0].rate_hz);
  const Time expected = *last_image_time_ + period;
  // Images after the end of the inertial readings would also be later than all of them.
  if (imu_.last() && *imu_.last() < expected) return false;
  diagnostics_->report(
      Severity::Warning, "image_clock_jump",
      fmt::format(
          "{}: the clock of the images was set ahead by {:.6g} s after stamp {} ns, that of the inertial "
          "readings was not; taken off the images from there on",
          source_->rig().cameras[0].name, (step - period).seconds(), last_image_time_->nanoseconds()));
  const Time from = *last_image_time_ + seconds(0.5 * step.seconds());
  reference->time = expected;
  for (OrderedStream<PendingImage>& camera : cameras_) {
    // Another camera may have its own clock.
    const PendingImage* next = &camera == &cameras_[0] ? nullptr : camera.peek();
    if (next != nullptr && std::abs((next->time - expected).seconds()) < 0.5 * period.seconds()) continue;
    camera.shiftFrom(from, period - step);
  }
  return true;
}

/// Handles inertial readings that jump ahead while the images continue.
bool Synchronizer::followImuClock(const ImuIntervals::Gap& gap, const PendingImage& reference) {
  if (reference.time <= gap.begin || reference.time > gap.end || source_->isLive()) return false;
  if (gap.length().seconds() < kLongestPause_s) {
    const double rate_hz = source_->rig().cameras[0].rate_hz;
    const auto images = static_cast<size_t>(std::ceil(kLongestPause_s * rate_hz));
    bool ends = false;
    const std::optional<Time> last = cameras_[0].reach(images, &ends);
    // Images exist within the pause and none after it, so the readings after it belong to these images.
    if (!ends || (last && *last > gap.end)) return false;
  }
  const Duration by = seconds(1.0 / source_->rig().imu.rate_hz) - gap.length();
  diagnostics_->report(
      Severity::Warning, "imu_clock_jump",
      fmt::format(
          "IMU: its clock was set ahead by {:.6g} s after stamp {} ns, that of the images was not; taken "
          "off the readings from there on",
          -by.seconds(), gap.begin.nanoseconds()));
  imu_.shiftFrom(gap.end, by);
  return true;
}

/// Reports a secondary camera of whose images few belong to images of the first one.
void Synchronizer::reportUnpaired(size_t camera, bool may_read_on) {
  constexpr double kFew = 0.5;
  CameraHistory& history = histories_[camera];
  const double images = static_cast<double>(recorded_images_);
  if (static_cast<double>(history.partners) >= kFew * images) return;
  OrderedStream<PendingImage>& stream = cameras_[camera];
  if (!history.span.get() && stream.peek() != nullptr) history.span.add(stream.peek()->time);
  while (may_read_on && stream.peek() != nullptr) history.span.add(stream.pop().time);
  const std::optional<TimeSpan>& span_of = history.span.get();
  if (!span_of || !images_span_.get()) return;
  const std::string& name = source_->rig().cameras[camera].name;
  const std::string& first = source_->rig().cameras[0].name;
  const std::optional<std::string> words =
      apart("the images of " + name, *span_of, "those of " + first, *images_span_.get(),
            "timeshift_cam_imu of " + name + " (in s, to be added to its stamps)");
  if (words) {
    diagnostics_->report(Severity::Serious, kClocksApart,
                         *words + fmt::format("; without it this run is one of {} alone", first));
    return;
  }
  diagnostics_->report(
      Severity::Warning, "cameras_unpaired",
      fmt::format(
          "{}: only {} of {} images of {} have one of {} at their time; its first image comes {:+.6g} s "
          "after that of {}, its last one {:+.6g} s: it ran for a part of the time or at another rate, "
          "or its clock is another one. Trigger both cameras together and stamp them by one clock",
          name, history.partners, recorded_images_, first, name,
          span(span_of->first, images_span_.get()->first).seconds(), first,
          span(span_of->last, images_span_.get()->last).seconds()));
}

/// Reports sensors whose readings do not overlap in time with those of the others. `may_read_on`: whether the
/// streams may be read to their ends.
void Synchronizer::reportApart(bool may_read_on) {
  if (may_read_on) imu_.drain();
  for (size_t i = 1; i < cameras_.size(); ++i) reportUnpaired(i, may_read_on);
  const auto report = [this](const std::string& name, const std::optional<TimeSpan>& span,
                             const char* other_name, const std::optional<TimeSpan>& other,
                             const char* offset) {
    if (!span || !other) return;
    const std::optional<std::string> words = apart(name, *span, other_name, *other, offset);
    if (words) diagnostics_->report(Severity::Serious, kClocksApart, *words);
  };
  report(
      "the images", images_span_.get(), "the inertial readings", imu_.span(),
      "timeshift_cam_imu (in s, to be added to the images' stamps; those above include its present value)");
  if (!last_packet_time_) return;
  sensors_.reportSpans(may_read_on,
                       [&](const std::string& name, const std::optional<TimeSpan>& span, const char* offset) {
                         report(name, span, "the images", images_span_.get(), offset);
                       });
}

}  // namespace lodeline
