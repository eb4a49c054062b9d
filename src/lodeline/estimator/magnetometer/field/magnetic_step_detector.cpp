#include "lodeline/estimator/magnetometer/field/magnetic_step_detector.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lodeline {
namespace {

constexpr int kSegments = 4;
constexpr int kFewestReadings = 2;  // in a segment
// A channel is recognized by its step within 3.4 sigma, where that is larger than so many sigma of the noise.
constexpr double kMaxChannelChiSquared = 16.3, kMinKnownSigmas = 4.0;
constexpr size_t kMostChannels = 4;

struct Segment {
  Vec3 sum_B = Vec3::Zero();
  double variance_sum_T2 = 0.0;
  int readings = 0;
  bool is_believed = true;

  Vec3 mean_B() const { return sum_B / readings; }
  double variance_T2() const { return variance_sum_T2 / (readings * readings); }
};

/// The part of a vector perpendicular to a unit vector.
Vec3 besides(const Vec3& direction, const Vec3& vector) { return vector - direction * direction.dot(vector); }

}  // namespace

std::optional<MagneticStepDetector::Candidate> MagneticStepDetector::candidate() const {
  std::array<Segment, kSegments> segments;
  for (const Reading& reading : readings_) {
    const double age_s = (readings_.back().time - reading.time).seconds();
    const auto segments_ago = static_cast<size_t>(age_s / options_.segment_s);
    Segment& segment = segments[kSegments - 1 - std::min<size_t>(segments_ago, kSegments - 1)];
    segment.sum_B += reading.difference_B;
    segment.variance_sum_T2 += reading.white_variance_T2;
    ++segment.readings;
    segment.is_believed = segment.is_believed && reading.is_believed;
  }
  for (const Segment& segment : segments) {
    if (segment.readings < kFewestReadings) return std::nullopt;
  }
  const auto& [a, b, c, d] = segments;
  Candidate result;
  result.step_B = 0.5 * (c.mean_B() + d.mean_B() - a.mean_B() - b.mean_B());
  result.besides_heading_T = besides(readings_.back().heading_B, result.step_B).norm();
  result.variance_T2 = 0.25 * (a.variance_T2() + b.variance_T2() + c.variance_T2() + d.variance_T2());
  const Vec3 along_B = result.step_B.normalized();
  const double before_T = along_B.dot(b.mean_B() - a.mean_B()),
               after_T = along_B.dot(d.mean_B() - c.mean_B());
  const double most_T = options_.max_slope * result.step_B.norm();
  // Noise may hide the slope of a steady growth on one side of the step, but hardly on both.
  result.is_sharp = a.is_believed && b.is_believed && std::abs(before_T) <= most_T &&
                    std::abs(after_T) <= most_T && before_T + after_T <= most_T;
  return result;
}

bool MagneticStepDetector::isStep(const Candidate& candidate) const {
  const double size_T = candidate.step_B.norm(), white_sigma_T = std::sqrt(candidate.variance_T2);
  const double least_T = std::max({options_.min_step_T, options_.min_white_sigmas * white_sigma_T,
                                   options_.min_usual_sizes * std::sqrt(usual_square_T2_)});
  const double least_besides_T =
      std::max(options_.min_besides_heading * size_T, 0.5 * options_.min_white_sigmas * white_sigma_T);
  return usual_weight_s_ >= options_.settling_s && candidate.is_sharp && size_T >= least_T &&
         size_T <= options_.max_step_T && candidate.besides_heading_T >= least_besides_T;
}

bool MagneticStepDetector::isStepOf(const Candidate& candidate, const Channel& channel,
                                    const Vec3& expected_B) const {
  const double variance_T2 = channel.variance_T2 + measuredVariance_T2(candidate);
  return (candidate.step_B - expected_B).squaredNorm() <= kMaxChannelChiSquared * variance_T2;
}

MagneticStepDetector::Channel* MagneticStepDetector::find(const Candidate& candidate) {
  Channel* best = nullptr;
  const auto off_T = [&](const Channel& channel) { return (candidate.step_B - channel.nextStep_B()).norm(); };
  for (Channel& channel : channels_) {
    if (!isStepOf(candidate, channel, channel.nextStep_B())) continue;
    if (best == nullptr || off_T(channel) < off_T(*best)) best = &channel;
  }
  return best;
}

bool MagneticStepDetector::endsMissedStart(const Candidate& candidate) const {
  return std::any_of(channels_.begin(), channels_.end(), [&](const Channel& channel) {
    return !channel.is_on && isStepOf(candidate, channel, -channel.field_B);
  });
}

bool MagneticStepDetector::isKnownStep(const Candidate& candidate) {
  const double least_T =
      std::max(kMinKnownSigmas * std::sqrt(candidate.variance_T2), 2.0 * std::sqrt(usual_square_T2_));
  return candidate.is_sharp && candidate.step_B.norm() >= least_T &&
         candidate.besides_heading_T >= 0.5 * least_T && find(candidate) != nullptr;
}

double MagneticStepDetector::measuredVariance_T2(const Candidate& step) const {
  return std::pow(options_.relative_sigma * step.step_B.norm(), 2) + step.variance_T2;
}

std::optional<MagneticStepDetector::Change> MagneticStepDetector::add(const Reading& reading) {
  const Time time = reading.time;
  const double since_s = readings_.empty() ? 0.0 : (time - readings_.back().time).seconds();
  readings_.push_back(reading);
  const double kept_s = kSegments * options_.segment_s;
  while ((time - readings_.front().time).seconds() >= kept_s) readings_.pop_front();
  const std::optional<Candidate> now = candidate();
  if (!now) {
    best_.reset();
    return std::nullopt;
  }
  // The middle of the segments passes over a step in several frames; the step is where the difference is
  // largest.
  const bool is_step = isStep(*now) || isKnownStep(*now);
  if (is_step && (!best_ || now->step_B.norm() > best_->step_B.norm())) {
    best_ = now;
    best_time_ = time;
  }
  if (best_) {
    const bool is_past = !is_step || (time - best_time_).seconds() > 0.5 * options_.segment_s;
    return is_past ? settle(*best_) : std::nullopt;
  }
  learnUsual(*now, since_s);
  return dropIfReturned(time);
}

void MagneticStepDetector::learnUsual(const Candidate& candidate, double since_s) {
  if (since_s <= 0.0) return;
  // A passing disturbance of seconds may be a hundred times as large and must not count as usual.
  const double most_T2 = 4.0 * std::max(usual_square_T2_, 3.0 * candidate.variance_T2);
  usual_weight_s_ = std::min(usual_weight_s_ + since_s, options_.memory_s);
  usual_square_T2_ +=
      (std::min(candidate.step_B.squaredNorm(), most_T2) - usual_square_T2_) * since_s / usual_weight_s_;
}

std::optional<MagneticStepDetector::Change> MagneticStepDetector::settle(const Candidate& step) {
  best_.reset();
  readings_.clear();  // so that the same step is not detected again
  returned_since_.reset();
  const double measured_T2 = measuredVariance_T2(step);
  if (Channel* channel = find(step)) {
    const double gain = channel->variance_T2 / (channel->variance_T2 + measured_T2);
    const double sigma_T = std::sqrt(channel->variance_T2);
    const Vec3 field_B = channel->is_on ? Vec3(-step.step_B) : step.step_B;
    channel->field_B += gain * (field_B - channel->field_B);
    channel->variance_T2 *= 1.0 - gain;
    channel->is_on = !channel->is_on;
    return sum(sigma_T);
  }
  if (endsMissedStart(step)) return std::nullopt;
  const bool ends_all = (step_B_ + step.step_B).norm() < options_.returned_share * step.step_B.norm();
  if (ends_all) {
    for (Channel& channel : channels_) channel.is_on = false;
    return sum(std::sqrt(measured_T2));
  }
  if (channels_.size() == kMostChannels) {
    const auto off =
        std::find_if(channels_.begin(), channels_.end(), [](const Channel& c) { return !c.is_on; });
    channels_.erase(off == channels_.end() ? channels_.begin() : off);
  }
  channels_.push_back({step.step_B, measured_T2, true});
  return sum(std::sqrt(measured_T2));
}

MagneticStepDetector::Change MagneticStepDetector::sum(double sigma_T) {
  const Vec3 before_B = step_B_;
  step_B_.setZero();
  for (const Channel& channel : channels_) {
    if (channel.is_on) step_B_ += channel.field_B;
  }
  return {step_B_ - before_B, sigma_T};
}

std::optional<MagneticStepDetector::Change> MagneticStepDetector::dropIfReturned(Time time) {
  if (step_B_.isZero()) return std::nullopt;
  // If the start of a current was not detected, the heading has followed its field. Its end then looks like a
  // step away from that heading. Size and dip of the field reveal the return.
  const Vec3& heading_B = readings_.back().heading_B;
  Vec3 sum_B = Vec3::Zero();
  for (const Reading& reading : readings_) sum_B += reading.difference_B;
  const Vec3 difference_B = besides(heading_B, sum_B / static_cast<double>(readings_.size()));
  const Vec3 step_B = besides(heading_B, step_B_);
  const double left = step_B.dot(difference_B) / std::max(step_B.squaredNorm(), 1e-30);
  if (left > options_.returned_share) {
    returned_since_.reset();
    return std::nullopt;
  }
  if (!returned_since_) returned_since_ = time;
  if ((time - *returned_since_).seconds() < options_.return_s) return std::nullopt;
  const double sigma_T = options_.relative_sigma * step_B_.norm();
  for (Channel& channel : channels_) channel.is_on = false;
  returned_since_.reset();
  return sum(sigma_T);
}

}  // namespace lodeline
