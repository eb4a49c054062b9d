#include "lodeline/estimator/initialization/relative_pose.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "lodeline/util/median.h"

namespace lodeline {

double parallaxAfterBestRotation(const std::vector<BearingPair>& pairs) {
  if (pairs.size() < 3) return 0.0;
  Mat3 correlation = Mat3::Zero();
  for (const BearingPair& pair : pairs) correlation += pair.bearing_b * pair.bearing_a.transpose();
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  const Mat3 b_from_a = svd.matrixU() * Vec3(1.0, 1.0, handedness).asDiagonal() * svd.matrixV().transpose();
  std::vector<double> angles;
  for (const BearingPair& pair : pairs) {
    const Vec3 turned = b_from_a * pair.bearing_a;
    angles.push_back(std::atan2(turned.cross(pair.bearing_b).norm(), turned.dot(pair.bearing_b)));
  }
  return median(std::move(angles));
}

std::optional<Rigid3> estimateRelativePose(const std::vector<BearingPair>& pairs, double max_error_rad,
                                           int min_inliers) {
  // The library works in the image plane at unit depth, so rays beyond about 80 degrees are skipped.
  constexpr double kMinDepth = 0.17;
  std::vector<cv::Point2d> points_a;
  std::vector<cv::Point2d> points_b;
  for (const BearingPair& pair : pairs) {
    if (pair.bearing_a.z() < kMinDepth || pair.bearing_b.z() < kMinDepth) continue;
    points_a.emplace_back(pair.bearing_a.x() / pair.bearing_a.z(), pair.bearing_a.y() / pair.bearing_a.z());
    points_b.emplace_back(pair.bearing_b.x() / pair.bearing_b.z(), pair.bearing_b.y() / pair.bearing_b.z());
  }
  if (static_cast<int>(points_a.size()) < std::max(min_inliers, 6)) return std::nullopt;
  cv::theRNG().state = 0x10de11e;
  cv::Mat inliers;
  const cv::Mat unit_camera = cv::Mat::eye(3, 3, CV_64F);
  const cv::Mat essential =
      cv::findEssentialMat(points_a, points_b, unit_camera, cv::RANSAC, 0.999, max_error_rad, inliers);
  if (essential.rows != 3 || essential.cols != 3) return std::nullopt;
  cv::Mat rotation;
  cv::Mat translation;
  const int in_front =
      cv::recoverPose(essential, points_a, points_b, unit_camera, rotation, translation, inliers);
  if (in_front < min_inliers) return std::nullopt;
  Mat3 b_rotation_a;
  Vec3 b_translation_a;
  cv::cv2eigen(rotation, b_rotation_a);
  cv::cv2eigen(translation, b_translation_a);
  return Rigid3(Quat(b_rotation_a).normalized(), b_translation_a);
}

}  // namespace lodeline
