#include "lodeline/mapping/recognition/loop_verifier.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/verification/descriptor_matcher.h"
#include "lodeline/mapping/recognition/verification/false_alarms.h"
#include "lodeline/mapping/recognition/verification/loop_ransac.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/median.h"
#include "lodeline/util/settings/option_check.h"

namespace lodeline {
namespace {

/// Six cells beyond the two of a sample are the least that can ever be no accident.
constexpr int kLeastMatches = 8;
/// Root mean square of the inliers' whitened residuals. That of chance is 1.51, because it fills the gate
/// evenly; that of normal errors is below 1.
constexpr double kLargestRms = 1.3;
/// Quantiles 99.9 % of chi squared, of 2 and 6 degrees of freedom.
constexpr double kTiltGate = 13.82, kPoseGate = 22.46;

/// Where matches are searched: near the places that the prediction gives, or in the whole view. The first
/// finds more of them, and each of the second is stronger evidence.
enum class Search { ByPrediction, Everywhere };

/// The work on one pair of keyframes.
class Verification {
 public:
  Verification(const LoopVerifierOptions& options, const MapKeyframe& old_keyframe,
               const MapKeyframe& new_keyframe, const std::optional<LoopPrediction>& prediction,
               Search search)
      : options_(options),
        old_(old_keyframe),
        new_(new_keyframe),
        prediction_(prediction),
        search_(search),
        old_view_(old_keyframe),
        new_view_(new_keyframe),
        vertical_(old_keyframe, new_keyframe) {
    loop_.old_keyframe = old_keyframe.id;
    loop_.new_keyframe = new_keyframe.id;
  }

  Loop run() {
    loop_.reason = findPose();
    if (!loop_.reason.empty()) return loop_;
    describePose();
    loop_.reason = objection();
    if (loop_.reason.empty()) loop_.status = LoopStatus::Verified;
    return loop_;
  }

 private:
  /// Matches and the best pose; returns the reason where there is none.
  std::string findPose() {
    const auto matches =
        matchDescriptors(old_, new_, search_ == Search::ByPrediction ? prediction_ : std::nullopt);
    loop_.matches = static_cast<int>(matches.size());
    for (const DescriptorMatch& match : matches) {
      const auto pair = correspondenceOf(old_, new_, match.features);
      if (!pair) continue;
      pairs_.push_back(*pair);
      searched_rad_.push_back(match.searched_rad);
    }
    if (static_cast<int>(pairs_.size()) < kLeastMatches) {
      return fmt::format("{} descriptors agree, {} of them on points with a position; at least {} are needed",
                         matches.size(), pairs_.size(), kLeastMatches);
    }
    loop_.status = LoopStatus::Matched;
    const auto found = findConsensus(pairs_, std::vector<bool>(pairs_.size(), true), old_, new_);
    if (!found) return "no rigid motion explains three matches";
    consensus_ = *found;
    constexpr int kRounds = 3, kIterations = 20;
    for (int round = 0; round < kRounds; ++round) {
      pose_ = refinePose(pairs_, consensus_.is_inlier, vertical_, consensus_.old_from_new, kIterations);
      consensus_ = consensusAt(pairs_, std::vector<bool>(pairs_.size(), true), pose_.old_from_new);
    }
    loop_.inliers = consensus_.inliers;
    loop_.old_from_new = pose_.old_from_new;
    return pose_.is_determined ? "" : "the matches do not determine all coordinates of the pose";
  }

  /// Covariance, figures and inliers.
  void describePose() {
    double squared = 0.0, rows = 0.0;
    std::vector<double> distances_m;
    std::vector<int> groups;
    for (size_t i = 0; i < pairs_.size(); ++i) {
      groups.push_back(old_view_.cellOf(pairs_[i].match.old_feature));
      if (!consensus_.is_inlier[i]) continue;
      const LoopResidual residual = residualOf(pairs_[i], pose_.old_from_new, false);
      squared += residual.squared();
      rows += residual.rows;
      distances_m.push_back(pairs_[i].point().distance_m);
      loop_.inlier_matches.push_back(pairs_[i].match);
    }
    loop_.rms_sigmas = rows > 0.0 ? std::sqrt(squared / rows) : 0.0;
    evidence_ =
        evidenceFor(pairs_, searched_rad_, consensus_.is_inlier, pose_.old_from_new, old_view_, new_view_);
    loop_.covered_share = evidence_.covered_share;
    if (distances_m.empty()) return;
    distance_m_ = median(std::move(distances_m));
    loop_.covariance = designEffect(pairs_, consensus_.is_inlier, groups, pose_) *
                       Mat6(informationOfStructure(pairs_, consensus_.is_inlier, pose_).inverse());
    // Each of both keyframes has its common errors.
    const double common_rad2 = 2.0 * std::pow(options_.common_rotation_rad, 2);
    const double common_m2 =
        (2.0 * std::pow(options_.common_distance_error, 2) + common_rad2) * distance_m_ * distance_m_;
    loop_.covariance.diagonal().head<3>().array() += common_m2;
    loop_.covariance.diagonal().tail<3>().array() += common_rad2;
  }

  /// Why the pose is not believed; empty where it is.
  std::string objection() {
    for (const auto check :
         {&Verification::byChance, &Verification::byCover, &Verification::byResiduals,
          &Verification::byWeakness, &Verification::byGravity, &Verification::bySecondCamera,
          &Verification::byAmbiguity, &Verification::byPrediction}) {
      if (std::string reason = (this->*check)(); !reason.empty()) return reason;
    }
    return "";
  }

  std::string byChance() {
    // Both searches together may let pass so many.
    const double most = prediction_ ? 0.5 * options_.max_false_alarms : options_.max_false_alarms;
    if (evidence_.log10_false_alarms <= std::log10(most)) return "";
    return fmt::format(
        "chance explains {} inliers of {} matches in {} cells: 1e{:.1f} such poses are expected",
        loop_.inliers, pairs_.size(), evidence_.cells, evidence_.log10_false_alarms);
  }

  std::string byCover() {
    if (evidence_.covered_share >= options_.min_covered_share) return "";
    return fmt::format("the inliers cover {:.0f} % of the view; at least {:.0f} % are needed",
                       100.0 * evidence_.covered_share, 100.0 * options_.min_covered_share);
  }

  std::string byResiduals() {
    if (loop_.rms_sigmas <= kLargestRms) return "";
    return fmt::format("residuals of {:.2f} sigmas (rms) fill their gate as those of chance do",
                       loop_.rms_sigmas);
  }

  /// A pose less accurate than a twentieth of the distance, or 1.5 degrees, moves the scene by more than
  /// neighbouring places differ.
  std::string byWeakness() {
    constexpr double kLargestShare = 0.05, kLargest_rad = 1.5 * kDegree;
    const auto widest = [](const Mat3& covariance) {
      return std::sqrt(Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvalues().z());
    };
    const double position_m = widest(loop_.covariance.topLeftCorner<3, 3>());
    const double rotation_rad = widest(loop_.covariance.bottomRightCorner<3, 3>());
    if (position_m <= kLargestShare * distance_m_ && rotation_rad <= kLargest_rad) return "";
    return fmt::format("degenerate geometry: sigma {:.2f} m at a distance of {:.1f} m, {:.1f} deg",
                       position_m, distance_m_, rotation_rad / kDegree);
  }

  std::string byGravity() {
    Eigen::Matrix<double, 2, 6> unused;
    const double squared = vertical_.residual(pose_.old_from_new.rotation, &unused).squaredNorm();
    if (squared <= kTiltGate) return "";
    return fmt::format("the pose contradicts gravity by {:.1f} deg",
                       std::sqrt(squared) * vertical_.sigma_rad / kDegree);
  }

  /// Inliers must also agree in the further cameras that observe them.
  std::string bySecondCamera() {
    constexpr double kLeastShare = 0.7;
    int observed = 0, agreeing = 0;
    for (size_t i = 0; i < pairs_.size(); ++i) {
      if (!consensus_.is_inlier[i]) continue;
      const LoopCorrespondence& pair = pairs_[i];
      const MapFeature& feature = pair.is_point_old
                                      ? new_.features[static_cast<size_t>(pair.match.new_feature)]
                                      : old_.features[static_cast<size_t>(pair.match.old_feature)];
      for (size_t r = 1; r < feature.rays.size(); ++r) {
        MapFeature further;
        further.rays = {feature.rays[r]};
        LoopCorrespondence there = pair;
        (pair.is_point_old ? there.in_new : there.in_old) = observationOf(further);
        ++observed;
        agreeing += isInlier(residualOf(there, pose_.old_from_new, false)) ? 1 : 0;
      }
    }
    if (agreeing >= kLeastShare * observed) return "";
    return fmt::format("of {} inliers seen by a further camera too, {} agree there", observed, agreeing);
  }

  /// Another pose with at least half of the cells, from the matches that the first one leaves.
  std::string byAmbiguity() {
    std::vector<bool> rest(pairs_.size());
    for (size_t i = 0; i < pairs_.size(); ++i) rest[i] = !consensus_.is_inlier[i];
    const auto second = findConsensus(pairs_, rest, old_, new_);
    if (!second) return "";
    const Evidence evidence =
        evidenceFor(pairs_, searched_rad_, second->is_inlier, second->old_from_new, old_view_, new_view_);
    if (2 * evidence.cells < evidence_.cells || evidence.log10_false_alarms > 0.0) return "";
    return fmt::format("not unique: a second pose has {} inliers in {} cells beside {} in {}",
                       second->inliers, evidence.cells, loop_.inliers, evidence_.cells);
  }

  std::string byPrediction() {
    if (!prediction_) return "";
    const Rigid3& predicted = prediction_->old_from_new;
    Eigen::Matrix<double, 6, 1> difference;
    difference << loop_.old_from_new.translation - predicted.translation,
        so3::log(loop_.old_from_new.rotation * predicted.rotation.conjugate());
    const Mat6 covariance = loop_.covariance + prediction_->covariance;
    loop_.mahalanobis_squared = difference.dot(covariance.ldlt().solve(difference));
    if (loop_.mahalanobis_squared <= kPoseGate) return "";
    return fmt::format(
        "{:.2f} m and {:.1f} deg from the prediction: squared Mahalanobis distance {:.1f}, limit "
        "{:.1f}",
        difference.head<3>().norm(), difference.tail<3>().norm() / kDegree, loop_.mahalanobis_squared,
        kPoseGate);
  }

  const LoopVerifierOptions& options_;
  const MapKeyframe& old_;
  const MapKeyframe& new_;
  const std::optional<LoopPrediction>& prediction_;
  Search search_;
  ViewGrid old_view_, new_view_;
  CommonVertical vertical_;
  Loop loop_;
  std::vector<LoopCorrespondence> pairs_;
  std::vector<double> searched_rad_;
  ConsensusPose consensus_;
  RefinedPose pose_;
  Evidence evidence_;
  double distance_m_ = 1.0;  ///< median of the inliers
};

}  // namespace

void LoopVerifierOptions::check() const {
  OptionCheck("loop_verifier")
      .positive("max_false_alarms", max_false_alarms)
      .within("min_covered_share", min_covered_share, 0.0, 1.0)
      .notNegative("common_distance_error", common_distance_error)
      .notNegative("common_rotation_rad", common_rotation_rad);
}

LoopVerifier::LoopVerifier(const LoopVerifierOptions& options) : options_(options) { options.check(); }

Loop LoopVerifier::verify(const MapKeyframe& old_keyframe, const MapKeyframe& new_keyframe,
                          const std::optional<LoopPrediction>& prediction) const {
  const auto searched = [&](Search search) {
    return Verification(options_, old_keyframe, new_keyframe, prediction, search).run();
  };
  Loop loop = searched(Search::ByPrediction);
  if (loop.status == LoopStatus::Verified || !prediction) return loop;
  Loop everywhere = searched(Search::Everywhere);
  return everywhere.status == LoopStatus::Verified ? everywhere : loop;
}

}  // namespace lodeline
