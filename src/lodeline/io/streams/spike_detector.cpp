#include "lodeline/io/streams/spike_detector.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lodeline {
namespace {

constexpr double kChanges = 12.0;  ///< jump threshold, in median changes
/// Jumps below these values are harmless at any noise.
constexpr double kLeastRate_rad_per_s = 0.15;
constexpr double kLeastForce_m_per_s2 = 1.5;
/// Changes between consecutive readings that no mechanical shock can cause.
constexpr double kNoKnock_rad_per_s = 15.0;
constexpr double kNoKnock_m_per_s2 = 150.0;
constexpr size_t kMostSpikes = 2;
constexpr size_t kLeastAfter = 3;
constexpr size_t kMedianOf = 5;

double limit(double scale, double least) { return std::max(least, kChanges * scale); }

/// Component-wise median of the first few readings.
Vec3 medianOf(std::span<const ImuSample> samples, Vec3 ImuSample::*reading) {
  const size_t count = std::min(samples.size(), kMedianOf);
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const ImuSample& sample : samples.first(count)) values.push_back((sample.*reading)[axis]);
    std::sort(values.begin(), values.end());
    result[axis] = values[count / 2];
  }
  return result;
}

/// Whether the readings after a spike of this size are as steady as without one; a shock would oscillate.
bool isCalm(std::span<const ImuSample> after, Vec3 ImuSample::*reading, double size) {
  constexpr size_t kChangesAfter = 3;
  constexpr double kCalm = 0.15;
  for (size_t i = 1; i < after.size() && i <= kChangesAfter; ++i) {
    if ((after[i].*reading - after[i - 1].*reading).norm() > kCalm * size) return false;
  }
  return true;
}

/// Whether all of the first `spikes` readings are outliers and the following ones are not.
bool standsOut(const ImuSample& before, std::span<const ImuSample> following, size_t spikes,
               Vec3 ImuSample::*reading, double limit, double no_knock) {
  constexpr double kReturned = 0.5;
  const Vec3 after = medianOf(following.subspan(spikes), reading);
  const Vec3 course = 0.5 * (before.*reading + after);
  double least = INFINITY;
  for (size_t i = 0; i < spikes; ++i) least = std::min(least, (following[i].*reading - course).norm());
  if (least < no_knock && !isCalm(following.subspan(spikes), reading, least)) return false;
  return least > limit && (following[spikes].*reading - course).norm() < kReturned * least &&
         (after - before.*reading).norm() < kReturned * least;
}

}  // namespace

bool isJump(const ReadingHistory& before, const ImuSample& sample) {
  if (!before.isFull()) return false;
  const ImuSample& last = before.last();
  // A change across missing readings is not a jump.
  const ImuSample& second_last = *(before.samples().end() - 2);
  constexpr double kPeriods = 2.5;
  if ((sample.time - last.time).seconds() > kPeriods * (last.time - second_last.time).seconds()) return false;
  const double rate = (sample.angular_velocity_B - last.angular_velocity_B).norm();
  const double force = (sample.specific_force_B - last.specific_force_B).norm();
  if (rate < kLeastRate_rad_per_s && force < kLeastForce_m_per_s2) return false;
  const ReadingScale scale = before.scale();
  return rate > limit(scale.rate_rad_per_s, kLeastRate_rad_per_s) ||
         force > limit(scale.force_m_per_s2, kLeastForce_m_per_s2);
}

size_t spikesAtFront(const ReadingHistory& before, std::span<const ImuSample> following) {
  const ReadingScale scale_before = before.scale();
  for (size_t spikes = 1; spikes <= kMostSpikes && following.size() >= spikes + kLeastAfter; ++spikes) {
    const ReadingScale scale_after = scaleOf(following.subspan(spikes));
    const double rate =
        limit(std::max(scale_before.rate_rad_per_s, scale_after.rate_rad_per_s), kLeastRate_rad_per_s);
    const double force =
        limit(std::max(scale_before.force_m_per_s2, scale_after.force_m_per_s2), kLeastForce_m_per_s2);
    if (standsOut(before.last(), following, spikes, &ImuSample::angular_velocity_B, rate,
                  kNoKnock_rad_per_s) ||
        standsOut(before.last(), following, spikes, &ImuSample::specific_force_B, force, kNoKnock_m_per_s2)) {
      return spikes;
    }
  }
  return 0;
}

}  // namespace lodeline
