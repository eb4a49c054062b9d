#pragma once

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Least uncertainty of odometry between two keyframes: a random walk over the path. Stereo odometry with a
/// calibrated rig and sharp images is not better than this. After 226 m it amounts to 3 cm and 0.3 degrees;
/// such dives end 0.2 to 1 m and 0.3 to 1 degrees off.
struct OdometryFloor {
  double position_m_per_sqrt_m = 2e-3;
  double rotation_rad_per_sqrt_m = 3.5e-4;
  /// Path that a rig at rest counts as, m. It keeps the covariance positive definite.
  double least_path_m = 0.01;

  void check() const;
  /// Diagonal covariance of [dp, dtheta] after a path.
  Mat6 covariance(double path_m) const;
};

/// Relative pose of two keyframes of one dive by odometry, with the part of the covariance that arose between
/// them. Sums of these along a way (OdometryChain) are the covariance of its ends.
///
/// Let e_i = [dp, dtheta] be the error of pose i in world axes and d = p_j - p_i. The relative pose has the
/// error R_i^T (e_j - A e_i) in axes of i, where A = [I, -[d]x; 0, I] carries an error of i along the path:
/// a rotation about p_i moves p_j. The error that arises between i and j is assumed independent of e_i.
/// Then, with R_i = diag(R_i, R_i),
///   P_j = A P_i A^T + R_i Q R_i^T   and so   Q = R_i^T (P_j - A P_i A^T) R_i,
/// An error of heading before i thus adds nothing to Q, although it moves p_j. Reported covariances
/// follow this only roughly: gravity, pressure or north may lower them, and errors of calibration cancel
/// on the way back. Q is therefore raised to the floor F of the path: its eigenvalues relative to F are
/// at least one, Q = L max(L^-1 Q L^-T, 1) L^T with F = L L^T.
///
/// `path_m`: length of the path between both; where it is shorter than their distance, the distance counts.
/// Throws InputError for keyframes of two dives and for poses or covariances that are not finite.
RelativePose odometryEdge(const MapKeyframe& previous, const MapKeyframe& next, double path_m = 0.0,
                          const OdometryFloor& floor = {});

/// The same for a factor of neighbouring keyframes, with the covariance of its error.
///
/// Where readings or old landmarks lower the covariance, they correct the estimate, and the relative pose
/// contains the correction. The correction of an optimal estimator does not correlate with the error that it
/// leaves (Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001), so
/// it has the covariance A P_i A^T - P_j. The sizes of the eigenvalues therefore count:
/// Q = L max(|L^-1 Q L^-T|, 1) L^T. Over a longer way, corrections take back the errors before them. So sums
/// of these are too large there.
RelativePose odometryFactor(const MapKeyframe& previous, const MapKeyframe& next,
                            const OdometryFloor& floor = {});

}  // namespace lodeline
