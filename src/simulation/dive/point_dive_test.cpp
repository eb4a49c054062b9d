#include "simulation/dive/point_dive.h"

#include <gtest/gtest.h>

#include <chrono>
#include <map>
#include <set>

namespace lodeline {
namespace {

TEST(PointDive, TwentyMinutesTakeSecondsAndStayFullOfTracks) {
  DiveMotionOptions motion;
  motion.duration_s = 1200.0;
  motion.path_length_m = 300.0;
  const ImuErrors imu = drawImuErrors(imuGrade("gx5-25"), {}, 1);
  const auto begin = std::chrono::steady_clock::now();
  const PointDive dive = makePointDive(motion, standardRig({}), imu);
  PointSimulationOptions options;
  options.imu = imu;
  options.frame_rate_hz = 15.0;
  PointSimulation simulation = dive.simulate(options);
  int frames = 0;
  size_t fewest = 1000;
  while (auto frame = simulation.next()) {
    ++frames;
    fewest = std::min(fewest, frame->tracks.observations.size());
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_EQ(frames, 1199 * 15 + 1);
  EXPECT_GE(fewest, 200u);
  EXPECT_EQ(dive.mounted.rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz, imu.gyroscope.noise_density);
}

/// Points of each second of a dive in a cave of that shape.
std::map<int, std::set<int>> pointsBySecond(const PointDive& dive, uint64_t seed) {
  PointSimulationOptions options;
  options.seed = seed;
  options.frame_rate_hz = 1.0;
  options.strongest_first = true;
  PointSimulation simulation = dive.simulate(options);
  std::map<int, std::set<int>> points;
  for (int second = 0; auto frame = simulation.next(); ++second) {
    for (const FeatureObservation& o : frame->tracks.observations)
      points[second].insert(simulation.pointOf(o.track));
  }
  return points;
}

PointDive caveDive(CaveShape shape, uint64_t dive_seed, double path_length_m = 150.0) {
  CavePlanOptions cave;
  cave.shape = shape;
  cave.seed = 3;
  cave.path_length_m = path_length_m;
  DiveMotionOptions motion;
  motion.seed = dive_seed;
  motion.duration_s = 4.5 * path_length_m;
  return makeCaveDive(cave, motion, standardRig({}), drawImuErrors(imuGrade("gx5-25"), {}, 1));
}

TEST(PointDive, LapsOfACircuitShowTheSamePointsAgain) {
  const PointDive dive = caveDive(CaveShape::Loop, 1);
  const auto points = pointsBySecond(dive, 1);
  std::set<int> first_lap, second_lap;
  size_t fewest = 1000;
  const double half_s = 0.5 * dive.motion.duration_s();
  for (const auto& [second, seen] : points) {
    fewest = std::min(fewest, seen.size());
    (second < half_s ? first_lap : second_lap).insert(seen.begin(), seen.end());
  }
  EXPECT_GE(fewest, 60u);
  size_t again = 0;
  for (const int point : second_lap) again += first_lap.count(point);
  EXPECT_GT(again, second_lap.size() / 2);
  // The body returns to where it was a lap before, and looks the same way.
  double nearest_m = 1e9;
  const Rigid3 end = dive.motion.at(dive.motion.duration_s() - 5.0).world_from_body;
  for (double t = 0.4 * dive.motion.duration_s(); t < 0.65 * dive.motion.duration_s(); t += 0.1)
    nearest_m = std::min(nearest_m, (dive.motion.at(t).world_from_body.translation - end.translation).norm());
  EXPECT_LT(nearest_m, 2.0);
}

TEST(PointDive, SecondDiveOfACaveHasTheSamePointsInItsOwnWorld) {
  for (const CaveShape shape : {CaveShape::Passage, CaveShape::Junction, CaveShape::Room}) {
    const double path_m = shape == CaveShape::Room ? 85.0 : 150.0;
    const PointDive first = caveDive(shape, 1, path_m), second = caveDive(shape, 2, path_m);
    ASSERT_EQ(first.landmarks.points().size(), second.landmarks.points().size());
    for (size_t i = 0; i < first.landmarks.points().size(); i += 1001) {
      EXPECT_LT(((first.landmarks.points()[i].position_W - first.cave_origin_W) -
                 (second.landmarks.points()[i].position_W - second.cave_origin_W))
                    .norm(),
                1e-9);
    }
    EXPECT_NE(first.cave_origin_W, second.cave_origin_W);
    const auto seen = pointsBySecond(first, 1), seen_again = pointsBySecond(second, 2);
    std::set<int> all, common;
    for (const auto& [second_s, points] : seen) {
      EXPECT_GE(points.size(), 50u) << static_cast<int>(shape) << " at " << second_s;
      all.insert(points.begin(), points.end());
    }
    for (const auto& [second_s, points] : seen_again) {
      for (const int point : points) {
        if (all.count(point) != 0) common.insert(point);
      }
    }
    EXPECT_GT(common.size(), all.size() / 4) << static_cast<int>(shape);
  }
}

}  // namespace
}  // namespace lodeline
