#include "simulation/sensors/dvl_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "simulation/motion/posed_motion.h"

namespace lodeline {
namespace {

// Flat floor at a height; beams that look up have no echo.
RangeFunction floorAt(double height_W) {
  return [=](const Vec3& origin, const Vec3& direction) -> std::optional<double> {
    if (direction.z() > -1e-6 || origin.z() < height_W) return std::nullopt;
    return (height_W - origin.z()) / direction.z();
  };
}

const RangeFunction kWall = [](const Vec3&, const Vec3&) -> std::optional<double> { return 3.0; };

// Least squares of the velocity from the beams with lock.
Vec3 velocityOf(const DvlSample& ping, const std::vector<Vec3>& beams_D) {
  Eigen::MatrixXd directions(ping.beams.size(), 3);
  Eigen::VectorXd velocities(ping.beams.size());
  for (size_t i = 0; i < ping.beams.size(); ++i) {
    directions.row(i) = beams_D[ping.beams[i].index];
    velocities[i] = ping.beams[i].velocity_m_per_s.value();
  }
  return directions.colPivHouseholderQr().solve(velocities);
}

class DvlModelTest : public testing::Test {
 protected:
  Motion motion_ = makeFigureEightMotion(1, 60.0, Rigid3());
  DvlCalibration calibration_;
  Rigid3 body_from_dvl_{so3::exp(Vec3(3.0, 0.2, -0.4)), Vec3(-0.2, 0.1, -0.15)};
};

TEST_F(DvlModelTest, BeamsGiveTheVelocityOfTheInstrumentBack) {
  DvlModel model(motion_, body_from_dvl_, calibration_.beams_D, kWall, {}, 1);
  for (double t = 0.0; t < 60.0; t += 0.2) {
    const Vec3 velocity_D = velocityOf(model.measure(t), calibration_.beams_D);
    // The derivative of the instrument's position.
    constexpr double kStep_s = 1e-4;
    const auto place = [&](double at_s) {
      return Vec3(motion_.at(at_s).world_from_body * body_from_dvl_.translation);
    };
    const Vec3 velocity_W = (place(t + kStep_s) - place(t - kStep_s)) / (2.0 * kStep_s);
    const Quat world_from_dvl = motion_.at(t).world_from_body.rotation * body_from_dvl_.rotation;
    EXPECT_LT((world_from_dvl * velocity_D - velocity_W).norm(), 1e-6) << t;
  }
}

TEST_F(DvlModelTest, IntegratedBeamsGiveThePathBack) {
  DvlModel model(motion_, body_from_dvl_, calibration_.beams_D, kWall, {}, 1);
  constexpr double kStep_s = 0.02;
  Vec3 path = Vec3::Zero();
  for (double t = 0.5 * kStep_s; t < 60.0; t += kStep_s) {
    const Quat world_from_dvl = motion_.at(t).world_from_body.rotation * body_from_dvl_.rotation;
    path += kStep_s * (world_from_dvl * velocityOf(model.measure(t), calibration_.beams_D));
  }
  const Vec3 travelled = motion_.at(60.0).world_from_body * body_from_dvl_.translation -
                         motion_.at(0.0).world_from_body * body_from_dvl_.translation;
  EXPECT_LT((path - travelled).norm(), 1e-3);
}

TEST_F(DvlModelTest, RangesReachTheSurfaceAlongTheBeamsWithinTheLimitsOfTheInstrument) {
  const Rigid3 looking_down(Quat(0.0, 1.0, 0.0, 0.0), Vec3::Zero());
  const Motion rest = makeMotionAtRest(1, 10.0, Rigid3());
  for (const double altitude_m : {0.04, 0.2, 20.0, 60.0}) {
    DvlModel model(rest, looking_down, calibration_.beams_D, floorAt(-altitude_m), {}, 1);
    const DvlSample ping = model.measure(1.0);
    ASSERT_EQ(ping.beams.size(), 4u);
    for (const DvlBeam& beam : ping.beams) {
      ASSERT_EQ(beam.range_m.has_value(), altitude_m > 0.1 && altitude_m < 50.0) << altitude_m;
      EXPECT_EQ(beam.velocity_m_per_s.has_value(), beam.range_m.has_value());
      if (!beam.range_m) continue;
      const Vec3 hit = rest.at(1.0).world_from_body *
                       (looking_down * Vec3(*beam.range_m * calibration_.beams_D[beam.index]));
      EXPECT_NEAR(hit.z(), -altitude_m, 1e-6);
    }
  }
}

TEST_F(DvlModelTest, NoiseScaleAndLossesAreAsStated) {
  DvlErrors errors;
  errors.velocity_noise_m_per_s = 0.01;
  errors.range_noise_m = 0.05;
  errors.scale = 0.02;
  errors.dropout_share = 0.3;
  errors.sentinel_share = 0.1;
  DvlModel model(motion_, body_from_dvl_, calibration_.beams_D, kWall, errors, 1);
  DvlModel exact(motion_, body_from_dvl_, calibration_.beams_D, kWall, {}, 1);
  double velocity_squares = 0.0, range_squares = 0.0, range_sum = 0.0;
  int good = 0, lost = 0, sentinels = 0;
  for (double t = 0.0; t < 60.0; t += 0.02) {
    const DvlSample ping = model.measure(t), truth = exact.measure(t);
    for (size_t i = 0; i < 4; ++i) {
      const DvlBeam& beam = ping.beams[i];
      if (!beam.velocity_m_per_s) {
        ++lost;
      } else if (*beam.range_m < 0.0) {
        EXPECT_EQ(*beam.velocity_m_per_s, 0.0);
        EXPECT_EQ(*beam.range_m, -2.0);
        ++sentinels;
      } else {
        ++good;
        velocity_squares += std::pow(*beam.velocity_m_per_s - 1.02 * *truth.beams[i].velocity_m_per_s, 2);
        range_squares += std::pow(*beam.range_m - 1.02 * 3.0, 2);
        range_sum += *beam.range_m;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(velocity_squares / good), 0.01, 0.0003);
  EXPECT_NEAR(std::sqrt(range_squares / good), 0.05, 0.0015);
  EXPECT_NEAR(range_sum / good, 3.06, 0.003);
  EXPECT_NEAR(sentinels / 12000.0, 0.1, 0.01);
  EXPECT_NEAR(lost / 12000.0, 0.9 * 0.3, 0.015);
}

TEST_F(DvlModelTest, LossesLeaveTheNoiseOfTheOtherBeamsAsItIs) {
  DvlErrors errors;
  errors.velocity_noise_m_per_s = 0.01;
  DvlModel all(motion_, body_from_dvl_, calibration_.beams_D, kWall, errors, 4);
  errors.dropout_share = 0.5;
  DvlModel some(motion_, body_from_dvl_, calibration_.beams_D, kWall, errors, 4);
  for (double t = 0.0; t < 20.0; t += 0.2) {
    const DvlSample a = all.measure(t), b = some.measure(t);
    for (size_t i = 0; i < 4; ++i) {
      if (!b.beams[i].velocity_m_per_s) continue;
      EXPECT_EQ(*a.beams[i].velocity_m_per_s, *b.beams[i].velocity_m_per_s);
    }
  }
}

}  // namespace
}  // namespace lodeline
