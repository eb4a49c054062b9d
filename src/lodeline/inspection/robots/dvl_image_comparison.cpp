#include "lodeline/inspection/robots/dvl_image_comparison.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "lodeline/inspection/robots/dvl_comparison.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr size_t kFewestPairs = 12;

/// Travel of the camera between two images, with what the DVL needs for the same.
struct ImageTravel {
  Time middle;
  Vec3 direction_B;  ///< unit
  Vec3 rate_B;
};

std::vector<ImageTravel> travelsOf(const std::vector<RayPairs>& pairs, const Quat& body_from_camera,
                                   const InertialPath& path) {
  std::vector<ImageTravel> travels;
  for (const RayPairs& pair : pairs) {
    const Time middle = pair.begin + Duration::fromSeconds(0.5 * (pair.end - pair.begin).seconds());
    const std::optional<Mat3> first = path.attitude(pair.begin), second = path.attitude(pair.end);
    const std::optional<Vec3> rate_B = path.rate_B(middle);
    if (!first || !second || !rate_B) continue;
    const Quat turn_B(Mat3(first->transpose() * *second));
    const std::optional<Vec3> direction_C =
        travelDirection(pair, body_from_camera.conjugate() * turn_B * body_from_camera);
    if (direction_C) travels.push_back({middle, body_from_camera * *direction_C, *rate_B});
  }
  return travels;
}

struct BodyPing {
  Time time;
  Vec3 velocity_B;  ///< of the instrument
};

std::vector<BodyPing> bodyPingsOf(const std::vector<DvlSample>& pings, const DvlCalibration& dvl) {
  std::vector<BodyPing> result;
  for (const DvlSample& ping : pings) {
    if (ping.track != DvlTrack::Bottom) continue;
    const std::optional<Vec3> velocity_D = velocityOf(ping, dvl);
    if (velocity_D) result.push_back({ping.time, dvl.body_from_dvl.rotation * *velocity_D});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const BodyPing& a, const BodyPing& b) { return a.time < b.time; });
  return result;
}

/// Velocity of the instrument between two pings that are not far apart.
std::optional<Vec3> velocityAt(const std::vector<BodyPing>& pings, Time time) {
  constexpr double kLongestGap_s = 0.6;
  const auto after = std::lower_bound(pings.begin(), pings.end(), time,
                                      [](const BodyPing& ping, Time t) { return ping.time < t; });
  if (after == pings.end() || after == pings.begin()) return std::nullopt;
  const BodyPing& before = *(after - 1);
  const double gap_s = (after->time - before.time).seconds();
  if (gap_s > kLongestGap_s) return std::nullopt;
  const double share = gap_s > 0.0 ? (time - before.time).seconds() / gap_s : 0.0;
  return Vec3((1.0 - share) * before.velocity_B + share * after->velocity_B);
}

/// Angles between both directions. `camera_from_dvl_B`: arm from the instrument to the camera.
std::vector<double> anglesOf(const std::vector<ImageTravel>& travels, const std::vector<BodyPing>& pings,
                             const Vec3& camera_from_dvl_B, const Mat3& axes, Duration offset) {
  constexpr double kLeastSpeed_m_per_s = 0.05;
  std::vector<double> angles_rad;
  for (const ImageTravel& travel : travels) {
    const std::optional<Vec3> velocity_B = velocityAt(pings, travel.middle - offset);
    if (!velocity_B) continue;
    const Vec3 of_camera_B = axes * *velocity_B + travel.rate_B.cross(camera_from_dvl_B);
    const double speed = of_camera_B.norm();
    if (speed < kLeastSpeed_m_per_s) continue;
    angles_rad.push_back(std::acos(std::clamp(travel.direction_B.dot(of_camera_B) / speed, -1.0, 1.0)));
  }
  return angles_rad;
}

}  // namespace

std::optional<Vec3> travelDirection(const RayPairs& pairs, const Quat& first_from_second) {
  constexpr double kLeastFlow_rad = 3e-3, kRobust_rad = 2e-3, kClearlyLarger = 6.0;
  constexpr size_t kFewestPoints = 15;
  if (pairs.first.size() < kFewestPoints) return std::nullopt;
  std::vector<Vec3> flows, normals;
  std::vector<double> sizes;
  for (size_t i = 0; i < pairs.first.size(); ++i) {
    const Vec3 turned = first_from_second * pairs.second[i];
    flows.push_back(pairs.first[i] - turned);
    normals.push_back(pairs.first[i].cross(turned));
    sizes.push_back(flows.back().norm());
  }
  if (median(sizes) < kLeastFlow_rad) return std::nullopt;
  Vec3 direction = Vec3::Zero();
  for (int iteration = 0; iteration < 8; ++iteration) {
    Mat3 sum = Mat3::Zero();
    for (const Vec3& normal : normals) {
      const double distance = iteration == 0 ? 0.0 : normal.dot(direction) / kRobust_rad;
      sum += normal * normal.transpose() / (1.0 + distance * distance);
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(sum);
    direction = solver.eigenvectors().col(0);
    // Where all points are about in one direction, the part of the travel along it is not known.
    if (solver.eigenvalues()[1] < kClearlyLarger * solver.eigenvalues()[0]) return std::nullopt;
  }
  // Points move against the travel: f_1 - R f_2 has its direction, without the part along the ray.
  double agreement = 0.0;
  for (const Vec3& flow : flows) agreement += flow.dot(direction);
  return agreement < 0.0 ? Vec3(-direction) : direction;
}

std::optional<DvlImageComparison> compareDvlWithImages(const std::vector<RayPairs>& pairs,
                                                       const Rigid3& body_from_camera,
                                                       const std::vector<DvlSample>& pings,
                                                       const DvlCalibration& dvl, const InertialPath& path) {
  const std::vector<ImageTravel> travels = travelsOf(pairs, body_from_camera.rotation, path);
  const std::vector<BodyPing> body_pings = bodyPingsOf(pings, dvl);
  const Vec3 arm_B = body_from_camera.translation - dvl.body_from_dvl.translation;
  const double stated_s = dvl.time_offset_to_imu_s;
  const auto angles = [&](const Mat3& axes, double shift_s) {
    return anglesOf(travels, body_pings, arm_B, axes, Duration::fromSeconds(stated_s + shift_s));
  };
  const std::vector<double> recorded = angles(Mat3::Identity(), 0.0);
  if (recorded.size() < kFewestPairs) return std::nullopt;
  DvlImageComparison result;
  result.pairs = static_cast<int>(recorded.size());
  result.angle_rad = result.best_angle_rad = result.angle_at_offset_rad = median(recorded);
  for (const Mat3& axes : signedAxes()) {
    const double angle_rad = median(angles(axes, 0.0));
    if (angle_rad >= result.best_angle_rad) continue;
    result.best_angle_rad = angle_rad;
    result.best_axes = axes;
  }
  constexpr int kSteps = 40;
  constexpr double kStep_s = 0.025;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const std::vector<double> shifted = angles(Mat3::Identity(), i * kStep_s);
    const double angle_rad = median(shifted);
    if (2 * shifted.size() < recorded.size() || angle_rad >= result.angle_at_offset_rad) continue;
    result.angle_at_offset_rad = angle_rad;
    result.time_offset_s = i * kStep_s;
  }
  return result;
}

}  // namespace lodeline
