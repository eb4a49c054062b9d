#include "lodeline/mapping/cloud/register_clouds.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/squared.h"
#include "lodeline/mapping/cloud/mirrored_cloud.h"
#include "lodeline/mapping/cloud/shape_knowledge.h"
#include "lodeline/mapping/cloud/shape_solver.h"

namespace lodeline {
namespace {

constexpr size_t kLeastCloudPoints = 60;
constexpr double kMostTilt_rad = 0.05;
/// Scores closer than this are those of two places that fit alike.
constexpr double kSimilarScore = 1.2;
/// Squared distances that a chi-squared variable of 1 to 4 degrees of freedom exceeds once in a thousand.
constexpr double kChiSquared999[] = {0.0, 10.83, 13.82, 16.27, 18.47};

/// One registration on its way from the candidate to the verdict.
class Registration {
 public:
  Registration(const LocalCloud& old_cloud, const LocalCloud& new_cloud, const Rigid3& old_from_new,
               const Mat6& covariance, const CloudRegistrationOptions& options)
      : old_(old_cloud), new_(new_cloud), options_(options), problem_(old_, new_, options.neighbours) {
    pose_covariance_ = covariance;
    result_.loop.old_keyframe = old_.keyframe;
    result_.loop.new_keyframe = new_.keyframe;
    result_.loop.source = "cloud";
    result_.loop.status = LoopStatus::Refused;
    result_.loop.old_from_new = old_from_new;
    result_.loop.covariance = kUnobservedFactor * covariance;
    prior_.old_from_new = problem_.upright(old_from_new, tilt_rad_);
    const Mat46 by_pose = problem_.parametersByPose(prior_.old_from_new);
    prior_.covariance = by_pose * covariance * by_pose.transpose();
  }

  CloudRegistration run() {
    result_.loop.reason = verdict();
    if (result_.loop.reason.empty()) result_.loop.status = LoopStatus::Verified;
    return result_;
  }

 private:
  /// The reason for a refusal, or nothing. The order is that of the cost.
  std::string verdict() {
    if (std::min(old_.points.size(), new_.points.size()) < kLeastCloudPoints)
      return fmt::format("{} and {} points, at least {} needed", old_.points.size(), new_.points.size(),
                         kLeastCloudPoints);
    if (tilt_rad_ > kMostTilt_rad) return "the prediction contradicts gravity";
    const auto starts =
        startsOf(problem_, prior_, options_.start_spacing_m, static_cast<size_t>(options_.most_starts));
    if (starts.empty()) return "the prediction is too uncertain to search";
    minima_ = minimaOf(problem_, prior_, starts);
    if (minima_.empty()) return "the clouds do not overlap";
    fit_ = minima_.front();
    rows_ = problem_.rows(fit_.state);
    knowledge_ = knowledgeOf(problem_, fit_.state, rows_,
                             {options_.scale_sigma, options_.tilt_sigma_rad, options_.local_drift});
    for (auto check :
         {&Registration::fitReason, &Registration::shapeReason, &Registration::predictionReason,
          &Registration::accuracyReason, &Registration::mirroredReason, &Registration::symmetryReason}) {
      const std::string reason = (this->*check)();
      if (!reason.empty()) return reason;
    }
    return "";
  }

  std::string fitReason() {
    Loop& loop = result_.loop;
    loop.matches = static_cast<int>(rows_.size());
    loop.inliers = knowledge_.inliers;
    loop.covered_share = static_cast<double>(knowledge_.inliers) / static_cast<double>(problem_.size());
    loop.rms_sigmas = knowledge_.usual_error;
    if (!fit_.converged) return "the registration does not converge";
    if (fit_.counterpart_share < options_.least_counterpart_share)
      return fmt::format("{:.0f} % of the points have a counterpart", 100.0 * fit_.counterpart_share);
    return "";
  }

  std::string accuracyReason() {
    const auto old_error = usualErrorWithin(old_, options_.neighbours);
    const auto new_error = usualErrorWithin(new_, options_.neighbours);
    if (!old_error || !new_error) return "a cloud is too sparse to know its own error";
    const double within_sigmas = std::max(*old_error, *new_error);
    if (result_.loop.rms_sigmas > options_.most_usual_error * within_sigmas)
      return fmt::format("the surfaces differ by {:.2f} sigmas, each within itself by {:.2f}",
                         result_.loop.rms_sigmas, within_sigmas);
    return "";
  }

  /// Another minimum that fits about as well and differs in an observed direction.
  bool isAmbiguous() const {
    const Mat4 twice = 2.0 * knowledge_.covariance;
    const Eigen::MatrixXd inverse = knowledge_.observedPart(twice).inverse();
    return std::any_of(minima_.begin() + 1, minima_.end(), [&](const ShapeFit& other) {
      if (other.score > kSimilarScore * fit_.score ||
          other.counterpart_share < options_.least_counterpart_share)
        return false;
      const Eigen::VectorXd gap =
          knowledge_.observedPart(problem_.difference(fit_.state.old_from_new, other.state.old_from_new));
      return gap.dot(inverse * gap) > kChiSquared999[knowledge_.observed];
    });
  }

  std::string shapeReason() {
    constexpr int kLeastDirections = 2;
    const int observed = knowledge_.observed;
    // A direction along which several minima fit alike is none that the shape observes.
    while (knowledge_.observed >= kLeastDirections && isAmbiguous()) --knowledge_.observed;
    result_.observed_directions = knowledge_.observed;
    if (knowledge_.observed < kLeastDirections)
      return observed < kLeastDirections ? "the shape does not hold the pose" : "two places fit alike";
    result_.information_share = 1.0 - knowledge_.noise_share[knowledge_.observed - 1];
    return "";
  }

  std::string predictionReason() {
    // The fit contains the prior; the measurement must not.
    Vec5 step = Vec5::Zero();
    step.head<4>() =
        knowledge_.basis.leftCols(knowledge_.observed) * knowledge_.step.head(knowledge_.observed);
    measured_ = problem_.moved(fit_.state, step).old_from_new;
    const Eigen::VectorXd gap = knowledge_.observedPart(problem_.difference(prior_.old_from_new, measured_));
    const Mat4 sum = knowledge_.covariance + prior_.covariance;
    result_.loop.mahalanobis_squared = gap.dot(knowledge_.observedPart(sum).ldlt().solve(gap));
    const Mat46 by_pose = problem_.parametersByPose(measured_);
    result_.information = by_pose.transpose() * knowledge_.information() * by_pose;
    result_.loop.old_from_new = measured_;
    const Mat6 weak = (kUnobservedFactor * pose_covariance_).inverse();
    const Mat6 covariance = (result_.information + weak).inverse();
    result_.loop.covariance = 0.5 * (covariance + covariance.transpose());
    if (result_.loop.mahalanobis_squared > kChiSquared999[knowledge_.observed])
      return fmt::format("contradicts the prediction: {:.1f} sigmas",
                         std::sqrt(result_.loop.mahalanobis_squared));
    return "";
  }

  std::string mirroredReason() {
    ShapePrior wide;
    wide.old_from_new = fit_.state.old_from_new;
    wide.covariance = Vec4(squared(0.3), squared(0.3), squared(0.3), squared(0.1)).asDiagonal();
    double best = 9.0;
    for (const LocalCloud& mirrored : mirroredClouds(new_)) {
      const ShapeProblem problem(old_, mirrored, options_.neighbours);
      const auto minima = minimaOf(problem, wide, startsOf(problem, wide, options_.start_spacing_m, 81));
      for (const ShapeFit& fit : minima) {
        if (fit.counterpart_share >= 0.7 * fit_.counterpart_share) best = std::min(best, fit.score);
      }
    }
    result_.mirrored_score_ratio = fit_.score / best;
    if (result_.mirrored_score_ratio > options_.most_score_of_mirrored)
      return fmt::format("a mirrored cloud fits nearly as well: {:.2f}", result_.mirrored_score_ratio);
    return "";
  }

  std::string symmetryReason() {
    const ShapeProblem back(new_, old_, options_.neighbours);
    ShapePrior prior;
    prior.old_from_new = fit_.state.old_from_new.inverse();
    prior.covariance = Vec4(squared(0.3), squared(0.3), squared(0.3), squared(0.05)).asDiagonal();
    const ShapeFit fit = fitShape(back, prior, {prior.old_from_new, 0.0}, 0.5, 1, 40);
    if (fit.counterpart_share < options_.least_counterpart_share)
      return fmt::format("{:.0f} % of the old points have a counterpart", 100.0 * fit.counterpart_share);
    const Eigen::VectorXd gap =
        knowledge_.observedPart(problem_.difference(measured_, fit.state.old_from_new.inverse()));
    const Mat4 twice = 2.0 * knowledge_.covariance;
    const double distance = gap.dot(knowledge_.observedPart(twice).ldlt().solve(gap));
    if (!fit.converged || distance > kChiSquared999[knowledge_.observed])
      return fmt::format("old to new and new to old differ by {:.1f} sigmas", std::sqrt(distance));
    return "";
  }

  const LocalCloud& old_;
  const LocalCloud& new_;
  const CloudRegistrationOptions& options_;
  ShapeProblem problem_;
  ShapePrior prior_;
  Mat6 pose_covariance_;
  double tilt_rad_ = 0.0;
  std::vector<ShapeFit> minima_;
  ShapeFit fit_;
  std::vector<ShapeRow> rows_;
  ShapeKnowledge knowledge_;
  Rigid3 measured_;
  CloudRegistration result_;
};

}  // namespace

void CloudRegistrationOptions::check() const {
  if (neighbours < 6 || neighbours > 32)
    throw UsageError(fmt::format("neighbours of a registration is {}; 6 to 32 are possible", neighbours));
  if (most_starts < 1) throw UsageError("most_starts of a registration must be at least 1");
  for (const auto& [value, name] : {std::pair(start_spacing_m, "start_spacing_m"),
                                    {least_counterpart_share, "least_counterpart_share"},
                                    {most_usual_error, "most_usual_error"},
                                    {most_score_of_mirrored, "most_score_of_mirrored"},
                                    {scale_sigma, "scale_sigma"},
                                    {tilt_sigma_rad, "tilt_sigma_rad"},
                                    {local_drift, "local_drift"}}) {
    if (!(value > 0.0) || !std::isfinite(value))
      throw UsageError(fmt::format("{} of a registration is {}; it must be positive", name, value));
  }
}

CloudRegistration registerClouds(const LocalCloud& old_cloud, const LocalCloud& new_cloud,
                                 const Rigid3& old_from_new, const Mat6& covariance,
                                 const CloudRegistrationOptions& options) {
  options.check();
  if (!old_from_new.matrix().allFinite()) throw InputError("the predicted pose of a cloud is not finite");
  if (!covariance.allFinite() || covariance.llt().info() != Eigen::Success)
    throw InputError("the covariance of a predicted pose is not positive definite");
  return Registration(old_cloud, new_cloud, old_from_new, covariance, options).run();
}

}  // namespace lodeline
