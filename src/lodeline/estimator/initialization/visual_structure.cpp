#include "lodeline/estimator/initialization/visual_structure.h"

#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/frontend/stereo/triangulation.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using PointMap = std::map<TrackId, Vec3>;

/// Points (axes of camera a) of the tracks in both frames on which the two views agree.
PointMap triangulatePair(const Window& window, const Frame& a, const Frame& b, const Rigid3& b_from_a,
                         double max_error_rad) {
  const TriangulationOptions options{.min_parallax_rad = 2.0 * max_error_rad, .max_rms_sigmas = 1.0};
  const Rigid3 a_from_b = b_from_a.inverse();
  PointMap points;
  for (const auto& [id, track] : window.tracks()) {
    const Observation* in_a = track.find(a.id, 0);
    const Observation* in_b = track.find(b.id, 0);
    if (!in_a || !in_b) continue;
    const Triangulation point = triangulate({{Rigid3(), in_a->measurement.bearing_C, max_error_rad},
                                             {a_from_b, in_b->measurement.bearing_C, max_error_rad}},
                                            options);
    if (point.good()) points[id] = point.point_W;
  }
  return points;
}

/// Camera pose from the points that the frame observes (resection, RANSAC), starting from a guess.
std::optional<Rigid3> resect(const Window& window, const Frame& frame, const PointMap& points,
                             const Rigid3& camera_from_visual_guess, double max_error_rad, int min_points) {
  std::vector<cv::Point3d> objects;
  std::vector<cv::Point2d> images;
  for (const auto& [id, point] : points) {
    const Observation* observation = window.tracks().at(id).find(frame.id, 0);
    if (!observation || observation->measurement.bearing_C.z() < 0.17) continue;
    const Vec3& ray = observation->measurement.bearing_C;
    objects.emplace_back(point.x(), point.y(), point.z());
    images.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  if (static_cast<int>(objects.size()) < min_points) return std::nullopt;
  cv::Mat rotation_vector;
  cv::Mat translation;
  cv::eigen2cv(so3::log(camera_from_visual_guess.rotation), rotation_vector);
  cv::eigen2cv(camera_from_visual_guess.translation, translation);
  cv::theRNG().state = 0x10de11e;
  cv::Mat inliers;
  if (!cv::solvePnPRansac(objects, images, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rotation_vector,
                          translation, true, 100, static_cast<float>(3.0 * max_error_rad), 0.99, inliers) ||
      inliers.rows < min_points) {
    return std::nullopt;
  }
  Vec3 rotation;
  Vec3 position;
  cv::cv2eigen(rotation_vector, rotation);
  cv::cv2eigen(translation, position);
  return Rigid3(so3::exp(rotation), position);
}

/// Gyroscope rotations from the oldest body frame to every frame, with the bias for which the last one equals
/// `oldest_from_newest`.
std::vector<Quat> gyroscopeRotations(const std::vector<Preintegration*>& intervals,
                                     const Quat& oldest_from_newest) {
  std::vector<Quat> rotations;
  Vec3 bias = intervals.front()->gyroscopeBias();
  for (int pass = 0; pass < 3; ++pass) {
    rotations.assign(1, Quat::Identity());
    Mat3 jacobian = Mat3::Zero();
    for (Preintegration* interval : intervals) {
      interval->repropagate(bias, interval->accelerometerBias());
      jacobian += rotations.back() * interval->biasJacobian().block<3, 3>(inertial_error::kTheta, 0);
      rotations.push_back((rotations.back() * interval->motion().gamma).normalized());
    }
    bias += jacobian.inverse() * so3::log(oldest_from_newest * rotations.back().conjugate());
  }
  return rotations;
}

}  // namespace

std::vector<BearingPair> commonTracks(const Window& window, const Frame& a, const Frame& b) {
  std::vector<BearingPair> pairs;
  for (const auto& [id, track] : window.tracks()) {
    const Observation* in_a = track.find(a.id, 0);
    const Observation* in_b = track.find(b.id, 0);
    if (in_a && in_b) pairs.push_back({in_a->measurement.bearing_C, in_b->measurement.bearing_C});
  }
  return pairs;
}

bool estimateStructure(Window& window, const std::vector<Preintegration*>& intervals,
                       const FactorBuilder& factors, double focal_px,
                       const MonoInitializationOptions& options) {
  Frame& oldest = *window.frames().front();
  Frame& newest = window.newest();
  const double max_error_rad = options.max_epipolar_error_px / focal_px;
  const std::optional<Rigid3> newest_from_oldest = estimateRelativePose(
      commonTracks(window, oldest, newest), max_error_rad, options.min_common_tracks / 2);
  if (!newest_from_oldest) return false;
  const PointMap points = triangulatePair(window, oldest, newest, *newest_from_oldest, max_error_rad);
  const int min_points = options.min_common_tracks / 2;
  if (static_cast<int>(points.size()) < min_points) return false;

  const Rigid3& body_from_camera = factors.bodyFromCamera(0);
  const Rigid3 camera_from_body = body_from_camera.inverse();
  const Rigid3 oldest_from_newest = newest_from_oldest->inverse();
  const std::vector<Quat> body_rotations = gyroscopeRotations(
      intervals, body_from_camera.rotation * oldest_from_newest.rotation * camera_from_body.rotation);
  Rigid3 visual_from_camera;
  for (size_t k = 0; k < window.frames().size(); ++k) {
    Frame& frame = *window.frames()[k];
    if (&frame == &newest) {
      visual_from_camera = oldest_from_newest;
    } else if (&frame != &oldest) {
      const Rigid3 guess(camera_from_body.rotation * body_rotations[k] * body_from_camera.rotation,
                         visual_from_camera.translation);
      const std::optional<Rigid3> camera_from_visual =
          resect(window, frame, points, guess.inverse(), max_error_rad, min_points);
      if (!camera_from_visual) return false;
      visual_from_camera = camera_from_visual->inverse();
    }
    poseToBlock(visual_from_camera * camera_from_body, frame.pose.data());
  }

  LandmarkOptions landmark_options;
  landmark_options.min_distance_m = 0.1;  // in units of the baseline here, not in metres
  landmark_options.max_inverse_distance_sigma_per_m = 0.05;
  Prior gauge;
  gauge.append(oldest.pose.data(), kPoseSize, Eigen::VectorXd::Constant(kPoseTangentSize, 1e-6));
  int landmarks = 0;
  for (int pass = 0; pass < 2; ++pass) {
    landmarks += createLandmarks(window, factors, landmark_options);
    if (!solveWithCeres(window, gauge, factors, {20, 1e-6}).usable) return false;
    removeOutliers(window, factors, landmark_options);
  }
  const ReprojectionStatistics statistics = reprojectionStatistics(window, factors, newest.id);
  return landmarks >= min_points && statistics.landmarks >= min_points && statistics.rms_sigmas < 2.0;
}

}  // namespace lodeline
