#include "lodeline/estimator/monitoring/inertial_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lodeline/estimator/monitoring/image_pose.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

Time at(double time_s) { return Time::fromSeconds(100.0 + time_s); }

/// Innovation with a given normalized square whose causes are new in every frame, along one of six directions
/// in turn.
Innovation innovation(int frame, double nis) {
  const Vec3 direction = (frame % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(frame / 2 % 3);
  return {std::sqrt(3.0 * nis) * direction, Mat3::Identity(), Mat3::Zero()};
}

TEST(InnovationWatch, TakesChanceForChance) {
  InnovationWatch watch(true);
  // Mean squares of three normal numbers, as large as one in a thousand.
  for (int i = 0; i < 1000; ++i) {
    watch.add(at(0.05 * i), innovation(i, i % 4 == 0 ? 5.4 : 1.0));
    ASSERT_FALSE(watch.isAlarmed()) << i;
  }
}

TEST(InnovationWatch, TakesOneWrongFrameForNoLastingContradiction) {
  InnovationWatch watch(true);
  for (int i = 0; i < 100; ++i) {
    watch.add(at(0.05 * i), innovation(i, i == 50 ? 1e8 : 1.0));
    ASSERT_FALSE(watch.isAlarmed()) << i;
  }
}

TEST(InnovationWatch, RaisesAnAlarmWithinHalfASecondAndEndsItASecondAfterTheContradiction) {
  InnovationWatch watch(true);
  for (int i = 0; i < 200; ++i) {
    const double time_s = 0.05 * i;
    watch.add(at(time_s), innovation(i, time_s >= 2.0 && time_s < 5.0 ? 20.0 : 1.0));
    if (time_s < 2.0 || time_s > 6.0) {
      EXPECT_FALSE(watch.isAlarmed()) << time_s;
    } else if (time_s > 2.5 && time_s < 5.9) {
      ASSERT_TRUE(watch.isAlarmed()) << time_s;
      EXPECT_EQ(watch.alarmedSince(), at(2.0));
    }
  }
}

// 2 sigmas in each frame are no surprise; 2 sigmas in the same direction for half a second are. Where the
// cause is one that lasts, such as the error of a bias within its covariance, they are no surprise either.
TEST(InnovationWatch, FindsAnErrorThatIsSmallInEachFrameAndAlwaysTheSame) {
  InnovationWatch new_causes(true), lasting_causes(true), without_sum(false);
  const Vec3 value = 2.0 * Vec3(0.6, -0.8, 0.0);
  for (int i = 0; i < 30; ++i) {
    new_causes.add(at(0.05 * i), {value, Mat3::Identity(), Mat3::Zero()});
    lasting_causes.add(at(0.05 * i), {value, Mat3::Zero(), Mat3::Identity()});
    without_sum.add(at(0.05 * i), {value, Mat3::Identity(), Mat3::Zero()});
  }
  EXPECT_TRUE(new_causes.isAlarmed());
  EXPECT_FALSE(lasting_causes.isAlarmed());
  EXPECT_FALSE(without_sum.isAlarmed());
}

class InertialMonitorTest : public testing::Test {
 protected:
  using Tamper = std::function<void(double time_s, SimulatedFrame& frame)>;

  TestSceneOptions scene(int cameras, double duration_s) const {
    TestSceneOptions options;
    options.cameras = cameras;
    options.duration_s = duration_s;
    options.points.tracks = 100;
    options.points.frame_rate_hz = 20.0;
    return options;
  }

  /// Counts frames by status and checks the reported position covariance.
  void run(const TestSceneOptions& options, const Tamper& tamper) {
    TestScene scene(options);
    EstimatorOptions estimator_options = honestOptions(options);
    ComparedEstimator estimator(scene, estimator_options);
    degraded_.clear();
    frames_ = degraded_count_ = beyond_five_sigma_ = 0;
    worst_error_m_ = 0.0;
    while (auto frame = scene.next()) {
      tamper(scene.secondsOf(frame->truth.time), *frame);
      last_ = estimator.add(*frame);
      if (!last_.initialized()) continue;
      ++frames_;
      const auto& covariance = last_.estimate.covariance;
      EXPECT_GT(covariance.diagonal().minCoeff(), 0.0) << last_.time_s;
      if (last_.estimate.status == Status::Degraded) {
        ++degraded_count_;
        degraded_.push_back(last_.time_s);
      }
      worst_error_m_ = std::max(worst_error_m_, last_.positionError());
      beyond_five_sigma_ += last_.positionError() > 5.0 * std::sqrt(covariance.topLeftCorner<3, 3>().trace());
    }
    findings_ = estimator.diagnostics();
  }

  /// Modifies the readings between two times.
  static Tamper readings(double begin_s, double end_s, const std::function<void(ImuSample&)>& change) {
    return [=](double time_s, SimulatedFrame& frame) {
      for (ImuSample& sample : frame.imu) {
        const double sample_s = time_s + (sample.time - frame.truth.time).seconds();
        if (sample_s >= begin_s && sample_s < end_s) change(sample);
      }
    };
  }

  std::vector<double> degraded_;
  int frames_ = 0, degraded_count_ = 0, beyond_five_sigma_ = 0;
  double worst_error_m_ = 0.0;
  Comparison last_;
  Diagnostics findings_;
};

constexpr double kForEver_s = 1e9;

TEST_F(InertialMonitorTest, SaysNothingOfHealthyReadings) {
  for (const int cameras : {1, 2}) {
    TestSceneOptions lively = scene(cameras, 20.0);
    lively.hurry_rad_per_s = 0.8;
    for (const uint64_t seed : {1, 2, 3}) {
      lively.seed = seed;
      run(lively, [](double, SimulatedFrame&) {});
      EXPECT_EQ(degraded_count_, 0) << cameras << " cameras, seed " << seed;
      EXPECT_EQ(findings_.count("motion_contradiction"), 0);
      EXPECT_EQ(findings_.count("image_out_of_place"), 0);
    }
  }
}

TEST_F(InertialMonitorTest, TakesUpASteppedGyroscopeBias) {
  const Vec3 step(0.2, -0.1, 0.15);
  run(scene(2, 14.0), readings(6.0, kForEver_s, [&](ImuSample& s) { s.angular_velocity_B += step; }));
  ASSERT_FALSE(degraded_.empty());
  EXPECT_NEAR(degraded_.front(), 6.0, 0.5);
  EXPECT_LT(degraded_.back(), 10.0) << "it did not recover";
  EXPECT_EQ(findings_.count("motion_contradiction"), 1);
  EXPECT_EQ(beyond_five_sigma_, 0);
  EXPECT_LT(worst_error_m_, 0.10);
  const Vec3 error = last_.estimate.state.gyroscope_bias_B - last_.true_gyroscope_bias_B - step;
  EXPECT_LT(error.norm(), 0.01);
}

TEST_F(InertialMonitorTest, FollowsNoImageThatShowsAnotherPlace) {
  const Quat turned = so3::exp(Vec3(0.0, 0.2, 0.0));
  run(scene(2, 10.0), [&](double time_s, SimulatedFrame& frame) {
    if (std::abs(time_s - 6.0) > 0.02) return;
    for (FeatureObservation& observation : frame.tracks.observations)
      observation.bearing_C = turned * observation.bearing_C;
  });
  EXPECT_EQ(findings_.count("image_out_of_place"), 1);
  EXPECT_EQ(degraded_count_, 0);
  EXPECT_LT(worst_error_m_, 0.05);
}

TEST(ImagePose, FindsTheFrameFromFarAway) {
  TestSceneOptions options;
  options.duration_s = 4.0;
  options.points.tracks = 100;
  TestScene scene(options);
  Diagnostics diagnostics;
  Estimator estimator(scene.rig(), honestOptions(options), &diagnostics);
  while (auto frame = scene.next()) estimator.add(frame->tracks, frame->imu);
  const FactorBuilder factors(scene.rig(), estimator.options());
  const Rigid3 estimated = estimator.window().newest().worldFromBody();
  Eigen::Matrix<double, 6, 1> moved;
  moved << 0.3, -0.2, 0.1, 0.1, -0.2, 0.15;
  const std::array<Rigid3, 1> starts = {perturbed(estimated, moved)};
  const auto pose = poseByImages(estimator.window(), factors, starts);
  ASSERT_TRUE(pose.has_value());
  EXPECT_GT(pose->agreeing, 30);
  const auto error = perturbationBetween(estimated, pose->world_from_body);
  const Eigen::Matrix<double, 6, 1> sigma = pose->covariance.diagonal().cwiseSqrt();
  for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(error[i]), 3.0 * sigma[i]) << i;
  EXPECT_LT(sigma.head<3>().norm(), 0.05);
  EXPECT_LT(sigma.tail<3>().norm(), 0.01);
}

}  // namespace
}  // namespace lodeline
