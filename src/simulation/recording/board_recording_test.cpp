#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "lodeline/board/board_detector.h"
#include "simulation/dive/dive_world.h"

namespace lodeline {
namespace {

Dive boardDive(const std::string& name, const std::vector<std::string>& effects = {}) {
  ScenarioChanges changes;
  changes.seconds = 20.0;
  changes.effects = effects;
  return makeDive(makeScenario(name, changes));
}

Vec2 trueCorner(const Dive& dive, size_t camera, const Camera& lens, int index, double time_s) {
  const Rigid3 world_from_camera =
      dive.motion.at(time_s).world_from_body * dive.errors.truth.rig.cameras[camera].body_from_camera;
  const Vec3 corner_W = dive.board->world_from_board * dive.board->board.corner_T(index);
  return *lens.project(world_from_camera.inverse() * corner_W);
}

/// Errors of the corners found in a few images, px.
std::vector<double> cornerErrors(const Dive& dive) {
  const ImageRenderer renderer(buildWorld(dive), dive.errors.truth.rig, renderSettings(dive));
  const WorldFromBodyAt motion = [&](double t) { return dive.motion.at(std::max(t, 0.0)).world_from_body; };
  const BoardDetector detector(dive.board->board);
  std::vector<double> errors_px;
  for (const double time_s : {3.0, 7.5, 12.2}) {
    for (size_t camera = 0; camera < 2; ++camera) {
      const auto lens = makeCamera(dive.errors.in_water.cameras[camera]);
      for (const BoardCorner& corner :
           detector.detect(renderer.render(static_cast<int>(camera), motion, time_s)))
        errors_px.push_back((corner.pixel - trueCorner(dive, camera, *lens, corner.index, time_s)).norm());
    }
  }
  return errors_px;
}

void expectExactCorners(const Dive& dive) {
  std::vector<double> errors_px = cornerErrors(dive);
  ASSERT_GT(errors_px.size(), 500u);
  std::sort(errors_px.begin(), errors_px.end());
  EXPECT_LT(errors_px[errors_px.size() / 2], 0.05);
  EXPECT_LT(errors_px[errors_px.size() * 99 / 100], 0.25);
}

TEST(BoardRecording, HasCornersWhereTheTrueCameraSeesThemInAir) { expectExactCorners(boardDive("board")); }

TEST(BoardRecording, HasCornersWhereTheTrueCameraSeesThemThroughAPort) {
  const Dive dive = boardDive("board_in_water", {"flat_port=on", "port_in_files=on"});
  ASSERT_TRUE(dive.errors.given.cameras[0].port);
  expectExactCorners(dive);
}

TEST(BoardRecording, MovesAboutAndAlongAllAxesWithTheBoardInView) {
  const Dive dive = boardDive("board");
  const auto lens = makeCamera(dive.errors.in_water.cameras[0]);
  Mat3 rates = Mat3::Zero(), accelerations = Mat3::Zero();
  int samples = 0, in_view = 0;
  for (double t = 0.5; t < 19.5; t += 0.1, ++samples) {
    const MotionState state = dive.motion.at(t);
    rates += state.angular_velocity_B * state.angular_velocity_B.transpose();
    accelerations += state.acceleration_W * state.acceleration_W.transpose();
    int corners = 0;
    for (int index = 0; index < dive.board->board.cornerCount(); ++index)
      corners += lens->contains(trueCorner(dive, 0, *lens, index, t)) ? 1 : 0;
    in_view += corners >= 24 ? 1 : 0;
  }
  const auto least = [&](const Mat3& sum) {
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Mat3>(sum / samples).eigenvalues()[0]);
  };
  EXPECT_GT(least(rates), 0.3);
  EXPECT_GT(least(accelerations), 0.2);
  EXPECT_GT(in_view, samples * 9 / 10);
}

TEST(BoardRecording, TakesTheLensesOutOfTheHousingInAir) {
  const Dive air = boardDive("board", {"flat_port=on"});
  const Dive water = boardDive("board_in_water", {"flat_port=on", "port_in_files=on"});
  EXPECT_FALSE(air.errors.port);
  EXPECT_FALSE(air.errors.given.cameras[0].port);
  EXPECT_EQ(air.errors.given.cameras[0].fx_px, water.errors.given.cameras[0].fx_px);
  EXPECT_EQ(air.errors.given.cameras[0].distortion, water.errors.given.cameras[0].distortion);
}

}  // namespace
}  // namespace lodeline
