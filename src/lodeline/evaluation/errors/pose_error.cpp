#include "lodeline/trajectory.h"

#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

double angleDeg(const Quat& rotation) { return so3::log(rotation).norm() * kDegreesPerRadian; }

double yawDeg(const Quat& rotation) {
  const Mat3 matrix = rotation.toRotationMatrix();
  return std::atan2(matrix(1, 0), matrix(0, 0)) * kDegreesPerRadian;
}

}  // namespace

Statistics AbsoluteErrors::position() const {
  std::vector<double> norms_m;
  for (const Vec3& error_m : position_m) norms_m.push_back(error_m.norm());
  return computeStatistics(norms_m);
}

Statistics AbsoluteErrors::rotation() const { return computeStatistics(rotation_deg); }

Statistics AbsoluteErrors::yaw() const {
  std::vector<double> magnitudes_deg;
  for (const double error_deg : yaw_deg) magnitudes_deg.push_back(std::abs(error_deg));
  return computeStatistics(magnitudes_deg);
}

AbsoluteErrors computeAbsoluteErrors(const std::vector<Rigid3>& aligned,
                                     const std::vector<Rigid3>& reference) {
  AbsoluteErrors errors;
  for (std::size_t i = 0; i < aligned.size(); ++i) {
    const Quat error = aligned[i].rotation * reference[i].rotation.conjugate();
    errors.position_m.push_back(aligned[i].translation - reference[i].translation);
    errors.rotation_deg.push_back(angleDeg(error));
    errors.yaw_deg.push_back(yawDeg(error));
  }
  return errors;
}

std::vector<Stretch> overlappingStretches(const std::vector<double>& distances_m, double length_m,
                                          double tolerance_m) {
  std::vector<Stretch> stretches;
  for (std::size_t start = 0; start < distances_m.size(); ++start) {
    const double wanted_m = distances_m[start] + length_m;
    const auto first = distances_m.begin() + static_cast<std::ptrdiff_t>(start) + 1;
    const auto after = std::lower_bound(first, distances_m.end(), wanted_m);
    // Beyond the end of the path sections would be systematically too short.
    if (after == distances_m.end()) break;
    const bool before_is_closer = after != first && wanted_m - *(after - 1) <= *after - wanted_m;
    const auto closest = before_is_closer ? after - 1 : after;
    if (std::abs(*closest - wanted_m) >= tolerance_m) continue;
    stretches.push_back({start, static_cast<std::size_t>(closest - distances_m.begin())});
  }
  return stretches;
}

std::vector<Stretch> consecutiveStretches(const std::vector<double>& distances_m, double length_m) {
  std::vector<Stretch> stretches;
  double last_end_m = 0.0;
  std::size_t start = 0;
  bool have_start = false;
  for (std::size_t i = 0; i < distances_m.size(); ++i) {
    if (distances_m[i] - last_end_m < length_m) continue;
    if (have_start) stretches.push_back({start, i});
    have_start = true;
    start = i;
    last_end_m = distances_m[i];
  }
  return stretches;
}

RelativeErrors computeRelativeErrors(const std::vector<Rigid3>& aligned, const std::vector<Rigid3>& reference,
                                     const std::vector<Stretch>& stretches, double length_m) {
  RelativeErrors errors;
  errors.length_m = length_m;
  for (const Stretch& stretch : stretches) {
    const Rigid3 estimate_motion = aligned[stretch.start].inverse() * aligned[stretch.end];
    const Rigid3 reference_motion = reference[stretch.start].inverse() * reference[stretch.end];
    const Rigid3 error = reference_motion.inverse() * estimate_motion;
    const Quat& world_from_end = aligned[stretch.end].rotation;
    const double translation_m = error.translation.norm();
    const double rotation_deg = angleDeg(error.rotation);
    errors.translation_m.push_back(translation_m);
    errors.translation_percent.push_back(100.0 * translation_m / length_m);
    errors.rotation_deg.push_back(rotation_deg);
    errors.rotation_deg_per_m.push_back(rotation_deg / length_m);
    errors.yaw_deg.push_back(std::abs(yawDeg(world_from_end * error.rotation * world_from_end.conjugate())));
  }
  return errors;
}

}  // namespace lodeline
