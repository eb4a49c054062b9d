#include "lodeline/io/streams/unit_change.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lodeline/util/angles.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kGravity_m_per_s2 = 9.80665;

/// Quantile of the magnitude of the specific force for a fraction of the readings.
double forceQuantile(std::span<const ImuSample> samples, double share) {
  std::vector<double> sizes;
  for (const ImuSample& sample : samples) sizes.push_back(sample.specific_force_B.norm());
  return orderStatistic(std::move(sizes), share);
}

double medianForce(std::span<const ImuSample> samples) { return forceQuantile(samples, 0.5); }

bool isBetween(double value, double least, double greatest) { return value > least && value < greatest; }

/// Whether readings multiplied by `factors` continue the earlier ones and have similar changes between
/// neighbours. The magnitude of gravity must be equal before and after.
bool explains(const ReadingFactors& factors, const ReadingHistory& before,
              std::span<const ImuSample> following) {
  constexpr double kChanges = 6.0, kLeastRate_rad_per_s = 0.03, kLeastForce_m_per_s2 = 0.3;
  constexpr double kAlike = 4.0, kSameGravity = 1.25;
  std::vector<ImuSample> then;
  for (const ImuSample& sample : following) then.push_back(factors.apply(sample));
  const ReadingScale was = before.scale(), is = scaleOf(then);
  const double rate = (then[0].angular_velocity_B - before.last().angular_velocity_B).norm();
  const double force = (then[0].specific_force_B - before.last().specific_force_B).norm();
  if (rate > std::max(kLeastRate_rad_per_s, kChanges * was.rate_rad_per_s)) return false;
  if (force > std::max(kLeastForce_m_per_s2, kChanges * was.force_m_per_s2)) return false;
  const auto alike = [&](double a, double b) { return a < kAlike * b && b < kAlike * a; };
  if (!alike(was.rate_rad_per_s, is.rate_rad_per_s)) return false;
  if (!alike(was.force_m_per_s2, is.force_m_per_s2)) return false;
  const double gravity = medianForce(then) / std::max(1e-9, medianForce(before.samples()));
  return isBetween(gravity, 1.0 / kSameGravity, kSameGravity);
}

struct NamedFactor {
  double factor;
  const char* words;
};

constexpr std::array<NamedFactor, 3> kRates = {
    {{1.0, ""},
     {kDegree, "the gyroscope's unit changes from rad/s to deg/s"},
     {1.0 / kDegree, "the gyroscope's unit changes back to rad/s"}}};
constexpr std::array<NamedFactor, 5> kForces = {
    {{1.0, ""},
     {kGravity_m_per_s2, "the accelerometer's unit changes from m/s^2 to g"},
     {1e-3 * kGravity_m_per_s2, "the accelerometer's unit changes from m/s^2 to mg"},
     {1.0 / kGravity_m_per_s2, "the accelerometer's unit changes back to m/s^2"},
     {1e3 / kGravity_m_per_s2, "the accelerometer's unit changes back to m/s^2"}}};

ReadingFactors factorsOf(const NamedFactor& rate, const NamedFactor& force) {
  const bool both = *rate.words != '\0' && *force.words != '\0';
  return {Vec3::Constant(rate.factor), Vec3::Constant(force.factor),
          std::string(rate.words) + (both ? " and " : "") + force.words};
}

ReadingFactors flipped(int axis, bool is_gyroscope) {
  ReadingFactors factors;
  (is_gyroscope ? factors.rate : factors.force)[axis] = -1.0;
  factors.words = std::string("the ") + (is_gyroscope ? "gyroscope's " : "accelerometer's ") + "xyz"[axis] +
                  " axis changes its sign";
  return factors;
}

}  // namespace

std::optional<ReadingFactors> changeOfUnit(const ReadingHistory& before,
                                           std::span<const ImuSample> following) {
  constexpr size_t kLeast = 10;
  if (!before.isFull() || following.size() < kLeast || explains({}, before, following)) return std::nullopt;
  for (const NamedFactor& rate : kRates) {
    for (const NamedFactor& force : kForces) {
      const ReadingFactors factors = factorsOf(rate, force);
      if (!factors.words.empty() && explains(factors, before, following)) return factors;
    }
  }
  // A value near zero does not show its sign.
  constexpr double kPlain = 5.0;
  const ReadingScale scale = before.scale();
  for (const bool is_gyroscope : {true, false}) {
    for (int axis = 0; axis < 3; ++axis) {
      const ReadingFactors factors = flipped(axis, is_gyroscope);
      const double value =
          is_gyroscope ? before.last().angular_velocity_B[axis] : before.last().specific_force_B[axis];
      const double change = is_gyroscope ? scale.rate_rad_per_s : scale.force_m_per_s2;
      if (std::abs(value) > kPlain * change && explains(factors, before, following)) return factors;
    }
  }
  return std::nullopt;
}

double forceToSI(std::span<const ImuSample> samples) {
  // An accelerometer with gravity removed may also read 1 m/s^2, but not constantly.
  constexpr double kSteady = 1.6;
  if (forceQuantile(samples, 0.8) > kSteady * forceQuantile(samples, 0.2)) return 1.0;
  const double size = medianForce(samples);
  for (const double unit : {kGravity_m_per_s2, 1e-3 * kGravity_m_per_s2}) {
    if (isBetween(size * unit / kGravity_m_per_s2, 0.75, 1.3)) return unit;
  }
  return 1.0;
}

}  // namespace lodeline
