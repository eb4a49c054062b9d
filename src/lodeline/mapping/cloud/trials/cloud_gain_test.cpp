#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdio>
#include <optional>

#include "lodeline/mapping/cloud/in_and_out.h"
#include "lodeline/mapping/cloud/trials/test_cloud_pairs.h"

namespace lodeline {
namespace {

using test::TubeNoise;
using test::TubeWorld;

constexpr double kPassage_m = 110.0;
constexpr double kKeyframe_m = 0.5;

/// Errors [dp, dyaw] of odometry along a path as linear functions of independent unit normal variables w:
///
///   dyaw' = b + white,   dp' = z x p' dyaw + |p'| d,
///
/// b a constant rate of heading, d a Gauss-Markov error of the velocity with a length of 20 m.
class DriftModel {
 public:
  explicit DriftModel(const std::vector<MapKeyframe>& truth) {
    constexpr size_t kHold = 8;  // keyframes with one value of the noise
    constexpr double kHold_m = 4.0;
    const auto steps = static_cast<Eigen::Index>(truth.size() / kHold + 1);
    variables_ = 1 + 4 * steps;
    Eigen::MatrixXd error = Eigen::MatrixXd::Zero(4, variables_);
    Eigen::MatrixXd velocity = Eigen::MatrixXd::Zero(3, variables_);
    const double decay = std::exp(-kHold_m / kLength_m);
    velocity(0, 1) = velocity(1, 2) = kVelocity;
    velocity(2, 3) = kVelocity / 5.0;
    errors_.push_back(error);
    for (size_t i = 1; i < truth.size(); ++i) {
      const Vec3 step = truth[i].odom_from_body.translation - truth[i - 1].odom_from_body.translation;
      const Eigen::Index first = 1 + 4 * static_cast<Eigen::Index>(i / kHold);
      if (i % kHold == 0) {
        velocity *= decay;
        const double fresh = kVelocity * std::sqrt(1.0 - decay * decay);
        velocity(0, first) = velocity(1, first + 1) = fresh;
        velocity(2, first + 2) = fresh / 5.0;  // the pressure sensor holds the height
      }
      error.topRows(3) += Vec3(-step.y(), step.x(), 0.0) * error.row(3) + step.norm() * velocity;
      error(3, 0) += kHeadingRate_rad_per_m * step.norm();
      error(3, first + 3) += kHeadingWalk * step.norm() / std::sqrt(kHold_m);
      errors_.push_back(error);
    }
  }

  const Eigen::MatrixXd& errors(size_t keyframe) const { return errors_[keyframe]; }
  Eigen::Index variables() const { return variables_; }

 private:
  static constexpr double kHeadingRate_rad_per_m = 2e-4;
  static constexpr double kHeadingWalk = 3e-4;  ///< rad per root of a metre
  static constexpr double kLength_m = 20.0;
  /// 0.3 % of the path of 220 m after eleven lengths of correlation.
  static constexpr double kVelocity = 0.003 * 2.3;

  Eigen::Index variables_ = 0;
  std::vector<Eigen::MatrixXd> errors_;
};

Rigid3 displaced(const Rigid3& pose, const Eigen::Vector4d& error) {
  return Rigid3((so3::exp(error[3] * Vec3::UnitZ()) * pose.rotation).normalized(),
                pose.translation + error.head<3>());
}

/// A dive in and out with drift, and the least-squares estimate of that drift from loops.
class DiveInAndOut {
 public:
  explicit DiveInAndOut(unsigned seed) : world_(test::Tube{.length_m = kPassage_m + 12.0, .seed = seed}) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    truth_ = test::swim(world_, 0.0, kPassage_m, TubeNoise{}, random);
    for (MapKeyframe& keyframe : test::swim(world_, kPassage_m, 0.0, TubeNoise{}, random))
      truth_.push_back(std::move(keyframe));
    for (size_t i = 0; i < truth_.size(); ++i) truth_[i].id = static_cast<KeyframeId>(i);
    model_.emplace(truth_);
    Eigen::VectorXd drift(model_->variables());
    for (double& value : drift) value = normal(random);
    drift[0] = 1.0;  // the rate of heading is that of the model: 2e-4 rad/m
    keyframes_ = truth_;
    for (size_t i = 0; i < truth_.size(); ++i)
      keyframes_[i].odom_from_body = displaced(truth_[i].odom_from_body, model_->errors(i) * drift);
    mean_ = Eigen::VectorXd::Zero(model_->variables());
    covariance_ = Eigen::MatrixXd::Identity(model_->variables(), model_->variables());
  }

  /// Registers pair after pair, the least uncertain first, and takes each into the estimate.
  void registerAll() {
    constexpr size_t kApart = 7;  // keyframes, 3.5 m
    std::vector<size_t> done;
    while (true) {
      bool is_new = false;
      for (const CloudPair& pair : inAndOutCandidates(corrected())) {
        const bool is_known = std::any_of(done.begin(), done.end(), [&](size_t other) {
          return std::max(other, pair.new_index) - std::min(other, pair.new_index) < kApart;
        });
        if (is_known) continue;
        done.push_back(pair.new_index);
        take(pair.old_index, pair.new_index);
        is_new = true;
        break;
      }
      if (!is_new) return;
    }
  }

  /// Root mean square of the misfit across the passage between the way in and the way out at one place.
  double crossTrackMisfit_m() const {
    double sum = 0.0;
    int number = 0;
    const size_t half = truth_.size() / 2;
    for (size_t i = 0; i < half; i += 4) {
      const size_t back = truth_.size() - 1 - i;
      const Eigen::Vector4d gap = errorOf(back) - errorOf(i);
      const double heading = world_.heading(kKeyframe_m * static_cast<double>(i));
      sum += squared(-std::sin(heading) * gap.x() + std::cos(heading) * gap.y());
      ++number;
    }
    return std::sqrt(sum / number);
  }

  int verified = 0, tried = 0, wrong = 0;

 private:
  Rigid3 estimateOf(size_t i) const {
    return displaced(keyframes_[i].odom_from_body, -model_->errors(i) * mean_);
  }
  /// Error [dp, dyaw] of the estimate.
  Eigen::Vector4d errorOf(size_t i) const {
    const Rigid3 estimate = estimateOf(i);
    Eigen::Vector4d error;
    error << estimate.translation - truth_[i].odom_from_body.translation,
        so3::log(estimate.rotation * truth_[i].odom_from_body.rotation.conjugate()).z();
    return error;
  }

  std::vector<MapKeyframe> corrected() const {
    std::vector<MapKeyframe> result(keyframes_.size());
    for (size_t i = 0; i < result.size(); ++i) {
      result[i].odom_from_body = estimateOf(i);
      const Mat4d covariance = model_->errors(i) * covariance_ * model_->errors(i).transpose();
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) result[i].covariance(a < 3 ? a : 5, b < 3 ? b : 5) = covariance(a, b);
      }
    }
    return result;
  }

  /// Difference of true and predicted relative pose by w: minus this times the error of w.
  Eigen::MatrixXd relativeBy(size_t older, size_t newer) const {
    const Rigid3 from = estimateOf(older), to = estimateOf(newer);
    const Vec3 lever = to.translation - from.translation;
    Eigen::MatrixXd result(6, model_->variables());
    const Mat3 turn = from.rotation.conjugate().toRotationMatrix();
    result.topRows(3) = turn * (model_->errors(newer).topRows(3) - model_->errors(older).topRows(3) -
                                Vec3(-lever.y(), lever.x(), 0.0) * model_->errors(older).row(3));
    result.bottomRows(3) =
        turn * Vec3::UnitZ() * (model_->errors(newer).row(3) - model_->errors(older).row(3));
    return result;
  }

  void take(size_t older, size_t newer) {
    const Rigid3 predicted = estimateOf(older).inverse() * estimateOf(newer);
    const Eigen::MatrixXd by_drift = relativeBy(older, newer);
    Mat6 prior = by_drift * covariance_ * by_drift.transpose();
    prior.diagonal().array() += squared(0.002);
    const CloudRegistration found = registerClouds(cloudOfKeyframes(keyframes_, older),
                                                   cloudOfKeyframes(keyframes_, newer), predicted, prior);
    ++tried;
    if (found.loop.status != LoopStatus::Verified) return;
    ++verified;
    const Rigid3 truth = truth_[older].odom_from_body.inverse() * truth_[newer].odom_from_body;
    if (test::worstError(found, truth) > 4.0) ++wrong;
    test::Vec6 gap;
    gap << found.loop.old_from_new.translation - predicted.translation,
        so3::log(found.loop.old_from_new.rotation * predicted.rotation.conjugate());
    const Mat6 innovation = by_drift * covariance_ * by_drift.transpose() + found.loop.covariance;
    const Eigen::MatrixXd gain = covariance_ * by_drift.transpose() * innovation.inverse();
    mean_ -= gain * gap;
    covariance_ -= gain * by_drift * covariance_;
    covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  }

  using Mat4d = Eigen::Matrix4d;

  TubeWorld world_;
  std::vector<MapKeyframe> truth_, keyframes_;
  std::optional<DriftModel> model_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
};

TEST(CloudGain, HalvesTheMisfitOfTheWayInAndTheWayOut) {
  for (const unsigned seed : {1u, 2u}) {
    DiveInAndOut dive(seed);
    const double before_m = dive.crossTrackMisfit_m();
    dive.registerAll();
    const double after_m = dive.crossTrackMisfit_m();
    std::printf("seed %u: %d of %d verified, %d wrong; misfit %.3f m -> %.3f m, %.2f\n", seed, dive.verified,
                dive.tried, dive.wrong, before_m, after_m, after_m / before_m);
    EXPECT_GT(before_m, 0.3) << seed;
    EXPECT_GE(dive.verified, dive.tried / 2) << seed;
    EXPECT_EQ(dive.wrong, 0) << seed;
    EXPECT_LE(after_m, 0.5 * before_m) << seed;
  }
}

}  // namespace
}  // namespace lodeline
