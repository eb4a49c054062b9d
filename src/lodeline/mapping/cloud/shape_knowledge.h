#pragma once

#include <optional>

#include "lodeline/mapping/cloud/shape_problem.h"

namespace lodeline {

/// What the rows of a fit say about the four parameters [centroid, yaw], without the prior.
///
/// H is the normal matrix of the rows without the offset. Normals are noisy, so that H has a part N that
/// noise alone would give: on a straight smooth passage all of H along the passage is noise. The columns of
/// `basis` solve N v = mu H v and are orthonormal under H. mu is between 0 and about 1 and has no unit,
/// whatever the units of the parameters. A direction is observed where mu is at most `kMostNoiseShare`.
///
/// The covariance is H^-1 M H^-1. M sums the products of scores over cubes of 1 m of wall, within which
/// errors are taken as alike (K.-Y. Liang and S. Zeger, "Longitudinal data analysis using generalized linear
/// models", 1986). Parameters that are not estimated add their share.
struct ShapeKnowledge {
  Mat4 hessian = Mat4::Zero();
  Mat4 basis = Mat4::Identity();  ///< columns v, by rising noise share
  Vec4 noise_share = Vec4::Ones();
  Mat4 covariance = Mat4::Identity();  ///< of the parameters
  Vec4 step = Vec4::Zero();            ///< along the basis, to the minimum without the prior
  int observed = 0;                    ///< leading columns of the basis that are observed
  double usual_error = 0.0;            ///< 1.4826 times the median of the rows' absolute errors, in sigmas
  int inliers = 0;                     ///< rows within three sigmas

  /// Observed coordinates along the basis of a difference of parameters.
  Eigen::VectorXd observedPart(const Vec4& difference) const;
  /// Covariance of these, for a covariance of the parameters.
  Eigen::MatrixXd observedPart(const Mat4& covariance_of_parameters) const;
  /// Information about the parameters, exactly zero along the other directions.
  Mat4 information() const;
};

constexpr double kMostNoiseShare = 0.5;

struct ConsideredSigmas {
  double scale = 0.01;      ///< relative, of the distances of each cloud
  double tilt_rad = 0.005;  ///< of each cloud about each horizontal axis
  /// Relative drift of odometry within each cloud. It shifts points by this part of the distance from which
  /// they were seen, and turns the cloud by this angle.
  double local_drift = 0.0075;
};

ShapeKnowledge knowledgeOf(const ShapeProblem& problem, const ShapeState& state,
                           const std::vector<ShapeRow>& rows, const ConsideredSigmas& considered);

/// Usual error of half of a cloud's points on the surface of the other half, in sigmas: what two views of the
/// same wall differ by. It is about 1 where the points' covariances are right. Nothing where the halves have
/// too few points.
std::optional<double> usualErrorWithin(const LocalCloud& cloud, int neighbours);

}  // namespace lodeline
