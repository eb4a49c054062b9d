#include "lodeline/mapping/session/tags/tag_places.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/control/control_residual.h"

namespace lodeline {
namespace {

/// 99.9 % quantile of chi squared with 2 degrees of freedom.
constexpr double kSpacingQuantile = 13.816;
/// Tags nearer than this to each other do not tell a place by their distance.
constexpr double kLeastSpacing_m = 0.5;

/// The point of a observation in the body of another keyframe, with its covariance.
TagSeenAt seenFrom(const TagSeenAt& seen, const Rigid3& from_from_to, const Mat6& covariance) {
  const Mat3 rotation = from_from_to.rotation.toRotationMatrix();
  const Vec3 arm = rotation * seen.centre_B;
  Eigen::Matrix<double, 3, 6> point_by_pose;
  point_by_pose << Mat3::Identity(), -so3::skew(arm);
  TagSeenAt moved;
  moved.keyframe = seen.keyframe;
  moved.centre_B = arm + from_from_to.translation;
  moved.covariance = rotation * seen.covariance * rotation.transpose() +
                     point_by_pose * covariance * point_by_pose.transpose();
  return moved;
}

/// Horizontal distance and difference in height of two tags with their variances.
struct Spacing {
  double horizontal_m = 0.0, height_m = 0.0;
  double horizontal_variance = 0.0, height_variance = 0.0;
};

Spacing spacingOf(const TagSeenAt& from, const TagSeenAt& to, const KnownKeyframes& known) {
  const RelativePose relative = known.between(from.keyframe, to.keyframe);
  const TagSeenAt there = seenFrom(to, relative.from_from_to, relative.covariance);
  // Roll and pitch of a keyframe hold in every world.
  const Mat3 level_from_body = known.at(from.keyframe).odom_from_body.rotation.toRotationMatrix();
  const Vec3 way = level_from_body * (there.centre_B - from.centre_B);
  const Mat3 covariance =
      level_from_body * (there.covariance + from.covariance) * level_from_body.transpose();
  Spacing spacing;
  spacing.horizontal_m = way.head<2>().norm();
  spacing.height_m = way.z();
  const Vec2 direction = way.head<2>() / std::max(spacing.horizontal_m, 1e-9);
  spacing.horizontal_variance = direction.dot(covariance.topLeftCorner<2, 2>() * direction);
  spacing.height_variance = covariance(2, 2);
  return spacing;
}

}  // namespace

bool TagAgreement::holds() const { return chi_squared <= kControlQuantile; }

TagAgreement agreementOf(const TagSeenAt& old_seen, const TagSeenAt& new_seen,
                         const LoopPrediction& old_from_new) {
  const TagSeenAt moved = seenFrom(new_seen, old_from_new.old_from_new, old_from_new.covariance);
  const Vec3 difference = old_seen.centre_B - moved.centre_B;
  const Mat3 covariance = old_seen.covariance + moved.covariance;
  return {difference.norm(), difference.dot(covariance.ldlt().solve(difference))};
}

bool haveSameSpacing(const TagPlace& own_1, const TagPlace& own_2, const TagPlace& earlier_1,
                     const TagPlace& earlier_2, const KnownKeyframes& known) {
  const Spacing own = spacingOf(own_1.observations.back(), own_2.observations.back(), known);
  const Spacing earlier = spacingOf(earlier_1.observations.back(), earlier_2.observations.back(), known);
  if (std::min(own.horizontal_m, earlier.horizontal_m) < kLeastSpacing_m) return false;
  const double horizontal = own.horizontal_m - earlier.horizontal_m;
  const double height = own.height_m - earlier.height_m;
  return horizontal * horizontal / (own.horizontal_variance + earlier.horizontal_variance) +
             height * height / (own.height_variance + earlier.height_variance) <=
         kSpacingQuantile;
}

}  // namespace lodeline
