#include "lodeline/evaluation/trajectory/azimuth_correction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Rotation of the odometry's world about z by one reading.
struct Correction {
  Time time;
  double angle_rad = 0.0;
};

double wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

std::vector<Correction> correctionsOf(const std::vector<StampedPose>& poses,
                                      const std::vector<StampedField>& field,
                                      const AzimuthCorrectionOptions& options) {
  std::vector<Correction> corrections;
  std::size_t next = 1;
  for (const StampedField& reading : field) {
    while (next < poses.size() && poses[next].time < reading.time) ++next;
    if (next >= poses.size()) break;
    const StampedPose& before = poses[next - 1];
    const StampedPose& after = poses[next];
    const double span_s = (after.time - before.time).seconds();
    if (reading.time < before.time || span_s > options.max_gap_s) continue;
    const double share = (reading.time - before.time).seconds() / span_s;
    const Quat world_from_body = before.world_from_body.rotation.slerp(share, after.world_from_body.rotation);
    const Vec3 field_W = world_from_body * reading.field_B;
    // A counterclockwise rotation of the world reduces every azimuth by its angle.
    const double azimuth_rad = std::atan2(field_W.x(), field_W.y());
    corrections.push_back({reading.time, wrapped(azimuth_rad - options.field_azimuth_rad)});
  }
  return corrections;
}

/// Median of angles around one direction, computed from their differences from their mean direction.
double medianAngle(std::vector<Correction>::const_iterator begin,
                   std::vector<Correction>::const_iterator end) {
  double sine = 0.0, cosine = 0.0;
  for (auto i = begin; i != end; ++i) {
    sine += std::sin(i->angle_rad);
    cosine += std::cos(i->angle_rad);
  }
  const double mean_rad = std::atan2(sine, cosine);
  std::vector<double> differences;
  for (auto i = begin; i != end; ++i) differences.push_back(wrapped(i->angle_rad - mean_rad));
  return mean_rad + median(std::move(differences));
}

/// The running median at every pose.
std::vector<double> smoothed(const std::vector<StampedPose>& poses,
                             const std::vector<Correction>& corrections, double window_s) {
  const Duration half = Duration::fromSeconds(0.5 * window_s);
  std::vector<std::optional<double>> at_pose;
  auto begin = corrections.begin();
  auto end = begin;
  for (const StampedPose& pose : poses) {
    while (begin != corrections.end() && begin->time < pose.time - half) ++begin;
    while (end != corrections.end() && end->time <= pose.time + half) ++end;
    if (begin != end) {
      at_pose.emplace_back(medianAngle(begin, end));
    } else {
      at_pose.push_back(at_pose.empty() ? std::nullopt : at_pose.back());
    }
  }
  // If the window is shorter than the interval of the poses, some poses may have no reading.
  const auto first =
      std::find_if(at_pose.begin(), at_pose.end(), [](const auto& a) { return a.has_value(); });
  const double at_start_rad = first == at_pose.end() ? corrections.front().angle_rad : **first;
  std::vector<double> angles_rad;
  for (const auto& angle_rad : at_pose) angles_rad.push_back(angle_rad.value_or(at_start_rad));
  return angles_rad;
}

Quat turn(double angle_rad) { return Quat(Eigen::AngleAxisd(angle_rad, Vec3::UnitZ())); }

}  // namespace

Trajectory correctHeadingByAzimuth(const Trajectory& odometry, const std::vector<StampedField>& field,
                                   const AzimuthCorrectionOptions& options) {
  const std::vector<StampedPose>& poses = odometry.poses;
  const std::vector<Correction> corrections = correctionsOf(poses, field, options);
  if (corrections.empty()) {
    throw InputError(odometry.name +
                     ": no magnetometer reading lies between two of its poses; its heading cannot be "
                     "corrected by the field");
  }
  const std::vector<double> angles_rad = smoothed(poses, corrections, options.window_s);
  Trajectory corrected = odometry;
  corrected.name = odometry.name + ", heading by the field's azimuth";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Rigid3& pose = corrected.poses[i].world_from_body;
    pose.rotation = (turn(angles_rad[i]) * poses[i].world_from_body.rotation).normalized();
    if (i == 0) continue;
    const double mean_rad = angles_rad[i - 1] + 0.5 * wrapped(angles_rad[i] - angles_rad[i - 1]);
    const Vec3 step = poses[i].world_from_body.translation - poses[i - 1].world_from_body.translation;
    pose.translation = corrected.poses[i - 1].world_from_body.translation + turn(mean_rad) * step;
  }
  return corrected;
}

}  // namespace lodeline
