#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/inspection/robots/current_comparison.h"
#include "lodeline/inspection/robots/dvl_comparison.h"
#include "lodeline/inspection/robots/dvl_image_comparison.h"

// A vehicle that turns and swims in circles: its inertial readings, pings of its DVL, field and currents.

namespace lodeline {
namespace {

constexpr double kImuRate_hz = 100.0, kLength_s = 60.0;
const Vec3 kGravity_W(0.0, 0.0, -9.80665);
const Vec3 kField_W(5e-6, 24e-6, -38e-6);

Time swimTime(double seconds) { return Time::fromSeconds(100.0 + seconds); }

Quat attitudeAt(double t) {
  return Quat(Eigen::AngleAxisd(0.5 * std::sin(0.4 * t) + 0.1 * t, Vec3::UnitZ()) *
              Eigen::AngleAxisd(0.2 * std::sin(0.7 * t), Vec3::UnitX()));
}
Vec3 velocityAt_W(double t) {
  return {0.4 * std::sin(0.9 * t), 0.3 * std::cos(0.6 * t), 0.1 * std::sin(1.3 * t)};
}
Vec3 accelerationAt_W(double t) {
  return {0.36 * std::cos(0.9 * t), -0.18 * std::sin(0.6 * t), 0.13 * std::cos(1.3 * t)};
}
Vec3 rateAt_B(double t) {
  constexpr double kStep_s = 1e-4;
  return so3::log(Quat(attitudeAt(t - kStep_s).conjugate() * attitudeAt(t + kStep_s))) / (2.0 * kStep_s);
}

std::vector<ImuSample> imu() {
  std::vector<ImuSample> samples;
  for (int i = 0; i < kLength_s * kImuRate_hz; ++i) {
    const double t = i / kImuRate_hz;
    samples.push_back(
        {swimTime(t), rateAt_B(t), attitudeAt(t).conjugate() * (accelerationAt_W(t) - kGravity_W)});
  }
  return samples;
}

DvlCalibration dvlCalibration() {
  DvlCalibration dvl;
  dvl.body_from_dvl = Rigid3(Quat(0.0, 1.0, 0.0, 0.0), Vec3(0.3, -0.1, -0.2));
  return dvl;
}

/// Pings at 5 Hz; `axes`: of the velocities in body axes as recorded; `delay_s`: of their stamps.
std::vector<DvlSample> pings(const Mat3& axes, double delay_s, bool has_beams) {
  const DvlCalibration dvl = dvlCalibration();
  std::vector<DvlSample> result;
  for (int i = 0; i < 5 * kLength_s; ++i) {
    const double t = 0.2 * i;
    const Vec3 velocity_B =
        attitudeAt(t).conjugate() * velocityAt_W(t) + rateAt_B(t).cross(dvl.body_from_dvl.translation);
    const Vec3 velocity_D = dvl.body_from_dvl.rotation.conjugate() * Vec3(axes * velocity_B);
    DvlSample ping;
    ping.time = swimTime(t + delay_s);
    if (!has_beams) ping.velocity_D = velocity_D;
    for (int beam = 0; has_beams && beam < 3; ++beam)
      ping.beams.push_back({beam, dvl.beams_D[static_cast<size_t>(beam)].dot(velocity_D), 2.0});
    result.push_back(ping);
  }
  return result;
}

TEST(DvlComparisonTest, FitsTheImuWhereEverythingIsRight) {
  const InertialPath path(imu(), Vec3::Zero());
  for (const bool has_beams : {false, true}) {
    const auto result = compareDvl(pings(Mat3::Identity(), 0.0, has_beams), dvlCalibration(), path);
    ASSERT_TRUE(result);
    EXPECT_GT(result->motion_m_per_s, 0.15);
    EXPECT_LT(result->remainder_m_per_s, 0.005);
    EXPECT_TRUE(result->best_axes.isIdentity());
    EXPECT_NEAR(result->time_offset_s, 0.0, 0.021);
  }
}

TEST(DvlComparisonTest, FindsWrongSignsAndExchangedAxes) {
  const InertialPath path(imu(), Vec3::Zero());
  Mat3 mirrored = Mat3::Identity(), exchanged = Mat3::Zero();
  mirrored(0, 0) = mirrored(1, 1) = -1.0;
  exchanged(0, 1) = exchanged(1, 0) = exchanged(2, 2) = 1.0;
  for (const Mat3& axes : {mirrored, exchanged}) {
    const auto result = compareDvl(pings(axes, 0.0, false), dvlCalibration(), path);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->best_axes.isApprox(axes.transpose())) << result->best_axes;
    EXPECT_LT(result->best_remainder_m_per_s, 0.3 * result->remainder_m_per_s);
  }
}

TEST(DvlComparisonTest, FindsADelay) {
  const InertialPath path(imu(), Vec3::Zero());
  const auto result = compareDvl(pings(Mat3::Identity(), 0.24, false), dvlCalibration(), path);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->time_offset_s, -0.24, 0.021);
  EXPECT_LT(result->remainder_at_offset_m_per_s, 0.3 * result->remainder_m_per_s);
}

TEST(DvlComparisonTest, SaysNothingOfPingsWithoutLock) {
  const InertialPath path(imu(), Vec3::Zero());
  std::vector<DvlSample> lost = pings(Mat3::Identity(), 0.0, true);
  for (DvlSample& ping : lost) ping.beams.pop_back();  // two beams are no vector
  EXPECT_FALSE(compareDvl(lost, dvlCalibration(), path));
  lost = pings(Mat3::Identity(), 0.0, false);
  for (DvlSample& ping : lost) ping.track = DvlTrack::Water;
  EXPECT_FALSE(compareDvl(lost, dvlCalibration(), path));
}

Vec3 placeAt_W(double t) {
  return {-0.4 / 0.9 * std::cos(0.9 * t), 0.5 * std::sin(0.6 * t), -0.1 / 1.3 * std::cos(1.3 * t)};
}

Rigid3 bodyFromCamera() { return Rigid3(so3::exp(Vec3(0.4, -1.1, 0.7)), Vec3(-0.1, 0.2, 0.05)); }

/// Rays of points in front of the camera, in pairs of images a tenth of a second apart; half a pixel of
/// noise.
std::vector<RayPairs> rayPairs() {
  std::vector<RayPairs> result;
  const Rigid3 body_from_camera = bodyFromCamera();
  const auto camera = [&](double t) { return Rigid3(attitudeAt(t), placeAt_W(t)) * body_from_camera; };
  int drawn = 0;
  const auto noise = [&drawn] {
    ++drawn;
    return 1e-3 * std::sin(12.9898 * drawn * drawn);
  };
  for (int i = 0; i < 150; ++i) {
    const double t = 5.0 + 0.3 * i;
    RayPairs pair{swimTime(t), swimTime(t + 0.1), {}, {}};
    for (int k = 0; k < 60; ++k) {
      const double across = 0.12 * (k % 8 - 3.5), down = 0.12 * (k / 8 - 3.5);
      const Vec3 point_W = camera(t) * Vec3((1.2 + 0.3 * std::sin(7.0 * k)) * Vec3(across, down, 1.0));
      pair.first.push_back(Vec3(across + noise(), down + noise(), 1.0).normalized());
      const Vec3 second = camera(t + 0.1).inverse() * point_W;
      pair.second.push_back(
          Vec3(second.x() / second.z() + noise(), second.y() / second.z() + noise(), 1.0).normalized());
    }
    result.push_back(pair);
  }
  return result;
}

std::optional<DvlImageComparison> compareImages(const Mat3& axes, double delay_s) {
  return compareDvlWithImages(rayPairs(), bodyFromCamera(), pings(axes, delay_s, false), dvlCalibration(),
                              InertialPath(imu(), Vec3::Zero()));
}

TEST(DvlImageComparisonTest, FitsTheImagesWhereEverythingIsRight) {
  const auto result = compareImages(Mat3::Identity(), 0.0);
  ASSERT_TRUE(result);
  EXPECT_GT(result->pairs, 60);
  EXPECT_LT(result->angle_rad, 0.15);
  EXPECT_TRUE(result->best_axes.isIdentity());
  EXPECT_NEAR(result->time_offset_s, 0.0, 0.051);
}

TEST(DvlImageComparisonTest, FindsWrongSignsAndExchangedAxes) {
  Mat3 mirrored = Mat3::Identity(), exchanged = Mat3::Zero();
  mirrored(0, 0) = mirrored(1, 1) = -1.0;
  exchanged(0, 1) = exchanged(1, 0) = exchanged(2, 2) = 1.0;
  for (const Mat3& axes : {mirrored, exchanged}) {
    const auto result = compareImages(axes, 0.0);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->best_axes.isApprox(axes.transpose())) << result->best_axes;
    EXPECT_LT(result->best_angle_rad, 0.3 * result->angle_rad);
  }
}

TEST(DvlImageComparisonTest, FindsADelay) {
  const auto result = compareImages(Mat3::Identity(), 0.3);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->time_offset_s, -0.3, 0.051);
  EXPECT_LT(result->angle_at_offset_rad, 0.6 * result->angle_rad);
}

TEST(DvlImageComparisonTest, SaysNothingWithoutFlow) {
  std::vector<RayPairs> still = rayPairs();
  for (RayPairs& pair : still) pair.second = pair.first;
  EXPECT_FALSE(travelDirection(still.front(), Quat::Identity()));
  std::vector<RayPairs> few = rayPairs();
  for (RayPairs& pair : few) pair.first.resize(8), pair.second.resize(8);
  EXPECT_FALSE(compareDvlWithImages(few, bodyFromCamera(), pings(Mat3::Identity(), 0.0, false),
                                    dvlCalibration(), InertialPath(imu(), Vec3::Zero())));
}

double currentAt(double t, size_t channel) {
  return channel == 0 ? 5.0 + 5.0 * std::sin(1.7 * t) : std::fmod(t, 6.0) < 3.0 ? 2.0 : 0.0;
}

struct Disturbed {
  std::vector<MagnetometerSample> field;
  std::vector<CurrentSample> currents;
  Rig rig;
  std::vector<Vec3> fields_T_per_A = {Vec3(3e-7, -1e-7, 2e-7), Vec3(-2e-7, 4e-7, 1e-7)};

  explicit Disturbed(double delay_s) {
    rig.magnetometer.emplace().body_from_magnetometer.rotation = so3::exp(Vec3(0.0, 0.0, 0.5));
    rig.currents.emplace().channels = {"thruster", "lamp", "idle"};
    const Quat body_from_magnetometer = rig.magnetometer->body_from_magnetometer.rotation;
    for (int i = 0; i < 50 * kLength_s; ++i) {
      const double t = 0.02 * i;
      Vec3 field_M =
          body_from_magnetometer.conjugate() * (attitudeAt(t).conjugate() * kField_W) + Vec3(1e-6, 2e-6, 0.0);
      for (size_t channel = 0; channel < 2; ++channel)
        field_M += currentAt(t, channel) * fields_T_per_A[channel];
      field.push_back({swimTime(t), field_M});
      if (i % 5 == 0) currents.push_back({swimTime(t + delay_s), {currentAt(t, 0), currentAt(t, 1), 0.02}});
    }
  }
};

TEST(CurrentComparisonTest, FindsTheFieldOfEveryChannel) {
  const InertialPath path(imu(), Vec3::Zero());
  const Disturbed data(0.0);
  const auto result = compareCurrents(data.field, data.currents, data.rig, 1.0, path);
  ASSERT_TRUE(result);
  EXPECT_GT(result->scatter_T, 5e-7);
  EXPECT_LT(result->explained_scatter_T, 0.2 * result->scatter_T);
  ASSERT_EQ(result->channels.size(), 2u) << "the current of the third hardly changes";
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(result->channels[i].name, data.rig.currents->channels[i]);
    EXPECT_LT((result->channels[i].field_T_per_A - data.fields_T_per_A[i]).norm(), 5e-8) << i;
  }
  EXPECT_NEAR(result->time_offset_s, 0.0, 0.051);
}

TEST(CurrentComparisonTest, FindsADelay) {
  const InertialPath path(imu(), Vec3::Zero());
  const Disturbed data(0.3);
  const auto result = compareCurrents(data.field, data.currents, data.rig, 1.0, path);
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->time_offset_s, -0.3, 0.051);
}

TEST(CurrentComparisonTest, SaysNothingOfConstantCurrents) {
  const InertialPath path(imu(), Vec3::Zero());
  Disturbed data(0.0);
  for (CurrentSample& sample : data.currents) sample.currents_A = {3.0, 2.0, 1.0};
  EXPECT_FALSE(compareCurrents(data.field, data.currents, data.rig, 1.0, path));
}

}  // namespace
}  // namespace lodeline
