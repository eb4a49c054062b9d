#include "lodeline/evaluation/errors/pose_convention.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

constexpr std::size_t kFewestPoses = 10;
constexpr double kMuchLess = 0.2;  ///< of the error as read

double positionRms_m(const Alignment& alignment, const PosePairs& pairs) {
  const std::vector<Rigid3> aligned = applyAlignment(alignment, pairs.estimate);
  double squares = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    squares += (aligned[i].translation - pairs.reference[i].translation).squaredNorm();
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

double positionRms_m(const PosePairs& pairs) {
  return positionRms_m(align(AlignmentType::SE3, pairs), pairs);
}

/// The alignment with a scale; nothing where the positions do not determine one.
std::optional<Alignment> alignWithScale(const PosePairs& pairs) {
  try {
    return align(AlignmentType::Sim3, pairs);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::vector<Rigid3> inverted(std::vector<Rigid3> poses) {
  for (Rigid3& pose : poses) pose = pose.inverse();
  return poses;
}

/// The unit of length that a scale stands for, in words.
std::string describeScale(double scale) {
  struct Unit {
    const char* name;
    double metres;
  };
  constexpr std::array<Unit, 3> kUnits = {{{"millimetres", 1e-3}, {"centimetres", 1e-2}, {"feet", 0.3048}}};
  constexpr double kSame = 0.03;
  for (const Unit& unit : kUnits) {
    if (std::abs(scale / unit.metres - 1.0) < kSame)
      return fmt::format("the estimate seems to be in {}", unit.name);
    if (std::abs(scale * unit.metres - 1.0) < kSame)
      return fmt::format("the reference seems to be in {}", unit.name);
  }
  return "the scale of one of them is wrong or unknown, as with one camera without an IMU (--align sim3)";
}

}  // namespace

bool checkPoseConvention(const PosePairs& pairs, AlignmentType alignment, Diagnostics& diagnostics) {
  if (pairs.size() < kFewestPoses) return false;
  const double as_read_m = positionRms_m(pairs);
  if (!(as_read_m > 0.0)) return false;
  const PosePairs of_estimate = {pairs.time, inverted(pairs.estimate), pairs.reference};
  const PosePairs of_reference = {pairs.time, pairs.estimate, inverted(pairs.reference)};
  const double estimate_m = positionRms_m(of_estimate);
  const double reference_m = positionRms_m(of_reference);
  const double inverted_m = std::min(estimate_m, reference_m);
  if (inverted_m < kMuchLess * as_read_m) {
    diagnostics.report(
        Severity::Warning, "poses_inverted",
        fmt::format(
            "the positions disagree by {:.3g} m rms; with the poses of the {} inverted by {:.3g} m: they "
            "map the world to the body; write the pose of the body in the world",
            as_read_m, estimate_m <= reference_m ? "estimate" : "reference", inverted_m));
    return true;
  }
  if (alignment == AlignmentType::Sim3) return false;
  constexpr double kFar = 1.2;
  const std::optional<Alignment> scaled = alignWithScale(pairs);
  if (!scaled) return false;
  const double scale = scaled->scale, scaled_m = positionRms_m(*scaled, pairs);
  const bool is_far = scale > kFar || scale * kFar < 1.0;
  if (!is_far || !(scale > 0.0) || scaled_m > kMuchLess * as_read_m) return false;
  diagnostics.report(
      Severity::Warning, "position_scale",
      fmt::format(
          "the positions disagree by {:.3g} m rms; with those of the estimate multiplied by {:.4g} by "
          "{:.3g} m: {}",
          as_read_m, scale, scaled_m, describeScale(scale)));
  return false;
}

std::string differenceOfClocks(const Trajectory& estimate, const Trajectory& reference) {
  constexpr double kHalfHour_s = 1800.0, kLargestZone_s = 14.5 * 3600.0;
  constexpr double kGpsEpoch_s = 315'964'800.0, kLeapSeconds_s = 40.0;
  constexpr double kFirstUnixTime_s = 1e9;  // 2001
  const Time first = estimate.poses.front().time, other = reference.poses.front().time;
  const double offset_s = span(other, first).seconds();
  const double longest_s = std::max(span(estimate.poses.back().time, first).seconds(),
                                    span(reference.poses.back().time, other).seconds());
  const double zones = std::round(offset_s / kHalfHour_s) * kHalfHour_s;
  const auto remedy = [](double s) { return fmt::format("; try --time-offset-s {:.12g}", s); };
  if (zones != 0.0 && std::abs(zones) < kLargestZone_s &&
      std::abs(offset_s - zones) < std::min(longest_s, 0.5 * kHalfHour_s)) {
    return fmt::format("two time zones, {:g} h apart?{}", std::abs(zones) / 3600.0, remedy(zones));
  }
  const double to_gps_s = std::abs(offset_s) - kGpsEpoch_s;
  if (std::abs(to_gps_s) < kLeapSeconds_s + longest_s) {
    constexpr double kGpsAhead_s = 18.0;  // of UTC since 2017
    return fmt::format("GPS time and Unix time?{}",
                       remedy(std::copysign(kGpsEpoch_s - kGpsAhead_s, offset_s)));
  }
  if ((first.seconds() < kFirstUnixTime_s) != (other.seconds() < kFirstUnixTime_s)) {
    return fmt::format("the clock of {} counts from its start?{} puts the first poses together",
                       first.seconds() < kFirstUnixTime_s ? estimate.name : reference.name, remedy(offset_s));
  }
  return "check the clocks, --time-offset-s and --time-tolerance-s";
}

}  // namespace lodeline
