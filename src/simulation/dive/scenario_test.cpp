#include "lodeline/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

TEST(Scenario, ReplicatesTheDivesOfThePaper) {
  EXPECT_DOUBLE_EQ(makeScenario("cave1_short", {}).path_length_m, 220.0);
  const Scenario long_dive = makeScenario("cave1_long", {});
  EXPECT_DOUBLE_EQ(long_dive.path_length_m, 506.0);
  EXPECT_EQ(long_dive.rig.cameras, 1);
  EXPECT_EQ(long_dive.imu_grade, "gv7");
  const Scenario mexico = makeScenario("dos_ojos", {});
  EXPECT_DOUBLE_EQ(mexico.path_length_m, 680.0);
  EXPECT_GT(mexico.duration_s, 3000.0);
  EXPECT_TRUE(mexico.decorated);
  for (const char* name : {"figure_eight", "bench"}) EXPECT_FALSE(makeScenario(name, {}).images);
}

TEST(Scenario, LengthAndDurationScaleTogetherUnlessBothAreGiven) {
  ScenarioChanges changes;
  changes.metres = 110.0;
  EXPECT_DOUBLE_EQ(makeScenario("cave1_short", changes).duration_s, 450.0);
  changes.seconds = 500.0;
  EXPECT_DOUBLE_EQ(makeScenario("cave1_short", changes).duration_s, 500.0);
  changes.metres.reset();
  EXPECT_NEAR(makeScenario("cave1_short", changes).path_length_m, 220.0 * 500.0 / 900.0, 1e-9);
}

TEST(Scenario, EffectsFollowRealismAndCanBeSwitchedAlone) {
  ScenarioChanges changes;
  EXPECT_FALSE(makeScenario("demo", changes).effects.has(Effect::FlatPort));
  changes.effects = {"flat_port=on", "imu_noise=off"};
  EXPECT_TRUE(makeScenario("demo", changes).effects.has(Effect::FlatPort));
  EXPECT_FALSE(makeScenario("demo", changes).effects.has(Effect::ImuNoise));
  changes.realism = "field";
  const Scenario field = makeScenario("demo", changes);
  EXPECT_TRUE(field.effects.has(Effect::SiltOuts));
  EXPECT_FALSE(field.effects.has(Effect::ImuNoise));
  EXPECT_FALSE(field.effects.has(Effect::RollingShutter));
}

TEST(Scenario, EveryEffectHasItsOwnName) {
  for (const EffectDescription& d : effectDescriptions()) {
    EffectSet set;
    set.set(std::string(d.name) + "=on");
    for (const EffectDescription& other : effectDescriptions()) {
      EXPECT_EQ(set.has(other.effect), other.effect == d.effect) << d.name;
    }
  }
}

TEST(Scenario, RefusesWhatMakesNoRecording) {
  const auto expectRefused = [](const char* name, const std::function<void(ScenarioChanges&)>& change) {
    ScenarioChanges changes;
    change(changes);
    EXPECT_THROW(makeScenario(name, changes), UsageError) << name;
  };
  expectRefused("cave9", [](ScenarioChanges&) {});
  expectRefused("bench", [](ScenarioChanges& c) { c.metres = 10.0; });
  expectRefused("demo", [](ScenarioChanges& c) { c.seconds = -1.0; });
  expectRefused("demo", [](ScenarioChanges& c) { c.seconds = std::nan(""); });
  expectRefused("demo", [](ScenarioChanges& c) { c.width_px = 10; });
  expectRefused("demo", [](ScenarioChanges& c) { c.cameras = 3; });
  expectRefused("demo", [](ScenarioChanges& c) { c.camera_rate_hz = 0.0; });
  expectRefused("demo", [](ScenarioChanges& c) { c.imu_grade = "perfect"; });
  expectRefused("demo", [](ScenarioChanges& c) { c.camera_model = "cubic"; });
  expectRefused("demo", [](ScenarioChanges& c) {
    c.camera_model = "ds";
    c.effects = {"flat_port=on"};
  });
  expectRefused("demo", [](ScenarioChanges& c) { c.realism = "dirty"; });
  expectRefused("demo", [](ScenarioChanges& c) { c.effects = {"silt=on"}; });
  expectRefused("demo", [](ScenarioChanges& c) { c.effects = {"silt_outs"}; });
}

// The focal length on the axis decides how wide the view is, whatever the model.
TEST(Scenario, TakesEveryCameraModel) {
  for (const CameraModel& model : cameraModels()) {
    ScenarioChanges changes;
    changes.camera_model = std::string(model.name);
    const Rig rig = standardRig(makeScenario("demo", changes).rig).rig;
    ASSERT_EQ(rig.cameras.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(rig.cameras[i].model, model.name);
      EXPECT_NEAR(focalLengthOnAxis_px(rig.cameras[i]),
                  model.typical.focal_length_share * 640.0 * (i == 0 ? 1.0 : 1.003), 1e-9);
      const auto camera = makeCamera(rig.cameras[i]);
      for (const Vec2& corner : {Vec2(0, 0), Vec2(639, 0), Vec2(0, 479), Vec2(639, 479)})
        EXPECT_TRUE(camera->unproject(corner)) << model.name;
    }
  }
}

TEST(Scenario, DescriptionTellsScenariosApart) {
  ScenarioChanges changes;
  const std::string plain = describe(makeScenario("demo", changes));
  EXPECT_EQ(plain, describe(makeScenario("demo", changes)));
  changes.effects = {"marine_snow=off"};
  EXPECT_NE(plain, describe(makeScenario("demo", changes)));
  changes = {};
  changes.camera_model = "ds";
  EXPECT_NE(plain, describe(makeScenario("demo", changes)));
  changes = {};
  changes.seed = 2;
  EXPECT_NE(plain, describe(makeScenario("demo", changes)));
}

}  // namespace
}  // namespace lodeline
