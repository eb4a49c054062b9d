// Dives of one cave: what they share, what differs, and the tags on the line.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <sstream>

#include "lodeline/board/tag_family.h"
#include "lodeline/diagnostics.h"
#include "simulation/dive/dive_world.h"

extern "C" {
#include <apriltag/apriltag.h>
}

namespace lodeline {
namespace {

Scenario caveOf(const char* name, uint64_t cave_seed, uint64_t dive_seed, const char* realism = "clean",
                int tags = 0) {
  ScenarioChanges changes;
  changes.cave_seed = cave_seed;
  changes.dive_seed = dive_seed;
  changes.realism = realism;
  if (tags > 0) changes.tags = tags;
  return makeScenario(name, changes);
}

TEST(FramedCave, SameCaveSeedSameRockOtherDiveSeedOtherMotionAndRig) {
  const Dive first = makeDive(caveOf("loop_cave", 3, 1)), second = makeDive(caveOf("loop_cave", 3, 2));
  CaveOptions options;
  options.seed = 3;
  options.max_triangles = 60'000;
  EXPECT_EQ(makeCaveMesh(first.cave->layout, options).positions,
            makeCaveMesh(second.cave->layout, options).positions);
  EXPECT_NE(first.cave->origin_W, second.cave->origin_W);
  EXPECT_GT((first.motion.at(100.0).world_from_body.translation -
             second.motion.at(100.0).world_from_body.translation)
                .norm(),
            0.05);
  EXPECT_NE(first.errors.imu.gyroscope.turn_on_bias, second.errors.imu.gyroscope.turn_on_bias);
  EXPECT_NE(first.start, second.start);
  // The same rock is in both worlds at places that differ by the origins.
  const auto a = diveLandmarks(first), b = diveLandmarks(second);
  ASSERT_EQ(a.points().size(), b.points().size());
  for (size_t i = 0; i < a.points().size(); i += 97) {
    EXPECT_LT(((a.points()[i].position_W - first.cave->origin_W) -
               (b.points()[i].position_W - second.cave->origin_W))
                  .norm(),
              1e-9);
  }
  // One surface for both.
  EXPECT_NEAR(first.surface_height_m - first.cave->origin_W.z(),
              second.surface_height_m - second.cave->origin_W.z(), 1e-12);
  const Dive elsewhere = makeDive(caveOf("loop_cave", 4, 1));
  EXPECT_GT((elsewhere.cave->layout.passages[0].at(20.0).position_W -
             first.cave->layout.passages[0].at(20.0).position_W)
                .norm(),
            0.5);
}

TEST(FramedCave, WallsOfTwoDivesAgreeToTheRoundingOfTheirWorlds) {
  const Scenario scenarios[2] = {caveOf("room", 3, 1), caveOf("room", 3, 2)};
  std::vector<double> ranges[2];
  for (int k = 0; k < 2; ++k) {
    const Dive dive = makeDive(scenarios[k]);
    CaveOptions options;
    options.seed = 3;
    options.max_triangles = 60'000;
    const auto world = buildCaveWorld(dive.cave->layout, options, {}, dive.cave->origin_W);
    EXPECT_EQ(world->texture_origin_W, dive.cave->origin_W.cast<float>());
    Random random(1, "test");
    for (int i = 0; i < 200; ++i) {
      const Vec3 place_C = dive.cave->layout.passages[0].at(random.uniform(1.0, 25.0)).position_W;
      ranges[k].push_back(*world->scene.range(place_C + dive.cave->origin_W, random.direction()));
    }
  }
  int apart = 0;
  for (size_t i = 0; i < ranges[0].size(); ++i) apart += std::abs(ranges[0][i] - ranges[1][i]) > 1e-3 ? 1 : 0;
  EXPECT_LE(apart, 2);  // rays past an edge
}

TEST(FramedCave, SeasonsDifferInTheFieldOnly) {
  const auto settingsOf = [](uint64_t dive_seed, const char* realism) {
    return renderSettings(makeDive(caveOf("two_entrances", 1, dive_seed, realism)));
  };
  const RenderSettings a = settingsOf(1, "field"), b = settingsOf(2, "field");
  EXPECT_GT(std::abs(a.water.attenuation_per_m - b.water.attenuation_per_m), 0.001);
  EXPECT_NE(a.snow.flakes_per_m3, b.snow.flakes_per_m3);
  EXPECT_NE(a.lamps[0].flood_intensity, b.lamps[0].flood_intensity);
  const RenderSettings c = settingsOf(1, "clean"), d = settingsOf(2, "clean");
  EXPECT_EQ(c.water.attenuation_per_m, d.water.attenuation_per_m);
  EXPECT_EQ(c.lamps[0].position_B, d.lamps[0].position_B);
}

TEST(FramedCave, SeedsOfCaveAndDiveAreThoseOfTheOptions) {
  ScenarioChanges changes;
  EXPECT_FALSE(makeScenario("cave1_short", changes).cave_seed);
  EXPECT_EQ(describe(makeScenario("cave1_short", changes)).find("cave_seed"), std::string::npos);
  changes.seed = 5;
  EXPECT_EQ(makeScenario("loop_cave", changes).cave_seed, 5u);
  EXPECT_EQ(makeScenario("loop_cave", changes).seed, 5u);
  changes.dive_seed = 9;
  const Scenario s = makeScenario("cave1_short", changes);
  EXPECT_EQ(s.cave_seed, 5u);
  EXPECT_EQ(s.seed, 9u);
  EXPECT_EQ(makeScenario("figure_eight", changes).seed, 9u);
  EXPECT_FALSE(makeScenario("figure_eight", changes).cave_seed);
}

TEST(FramedCave, RefusesOptionsWithoutSuchACave) {
  const auto refused = [](const char* name, void (*change)(ScenarioChanges&)) {
    ScenarioChanges changes;
    change(changes);
    EXPECT_THROW(makeDive(makeScenario(name, changes)), UsageError) << name;
  };
  refused("board", [](ScenarioChanges& c) { c.tags = 3; });
  refused("open_water", [](ScenarioChanges& c) { c.cave_seed = 3; });
  refused("loop_cave", [](ScenarioChanges& c) { c.entrance = 2; });
  refused("cave1_short", [](ScenarioChanges& c) { c.laps = 2; });
  refused("cave1_short", [](ScenarioChanges& c) { c.entrance = 3; });
  refused("cave1_short", [](ScenarioChanges& c) { c.cave_metres = 20.0; });
  refused("cave1_short", [](ScenarioChanges& c) { c.tags = 1000; });
  refused("loop_cave", [](ScenarioChanges& c) { c.laps = -1; });
  refused("loop_cave", [](ScenarioChanges& c) { c.metres = 40.0; });
  refused("junction", [](ScenarioChanges& c) { c.metres = 20.0; });
  refused("room", [](ScenarioChanges& c) { c.metres = 300.0; });
}

TEST(FramedCave, SecondEntranceIsDeeperAtTheStartInOneFrame) {
  ScenarioChanges changes;
  changes.entrance = 2;
  const Dive first = makeDive(makeScenario("two_entrances", {})),
             second = makeDive(makeScenario("two_entrances", changes));
  EXPECT_NEAR(second.surface_height_m - first.surface_height_m, 6.4, 3.0);
  // Both worlds start at their body; in the cave they are the length of the cave apart.
  EXPECT_GT((first.cave->origin_W - second.cave->origin_W).norm(), 30.0);
}

// --- tags ---

/// Corners of the tags that libapriltag finds, by their numbers, px; the first pixel's centre is (0, 0).
std::map<int, std::array<Vec2, 4>> foundTags(const cv::Mat& image) {
  const TagFamily family(1);
  const std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector(
      apriltag_detector_create(), apriltag_detector_destroy);
  detector->nthreads = 1;
  detector->quad_decimate = 1.0f;
  apriltag_detector_add_family(detector.get(), family.get());
  image_u8_t view = {image.cols, image.rows, static_cast<int>(image.step), image.data};
  zarray_t* detections = apriltag_detector_detect(detector.get(), &view);
  std::map<int, std::array<Vec2, 4>> found;
  for (int i = 0; i < zarray_size(detections); ++i) {
    apriltag_detection_t* detection = nullptr;
    zarray_get(detections, i, &detection);
    if (detection->hamming > 0 || detection->decision_margin < 30.0f) continue;
    for (size_t k = 0; k < 4; ++k)
      found[detection->id][k] = Vec2(detection->p[k][0] - 0.5, detection->p[k][1] - 0.5);
  }
  apriltag_detections_destroy(detections);
  return found;
}

/// Instant at which the tag's corners are all in view, the tag faces the camera, and its image is largest.
double bestViewOf(const Dive& dive, const LineTag& tag, const Camera& lens) {
  double best_s = -1.0, largest_px = 0.0;
  for (double t = 1.0; t < dive.motion.duration_s() - 1.0; t += 0.2) {
    const Rigid3 camera_from_world =
        (dive.motion.at(t).world_from_body * dive.errors.truth.rig.cameras[0].body_from_camera).inverse();
    const Vec3 centre = camera_from_world * Vec3(tag.cave_from_tag.translation + dive.cave->origin_W);
    const Vec3 normal = camera_from_world.rotation * tag.cave_from_tag.rotation * Vec3::UnitZ();
    if (centre.norm() > 4.0 || -normal.dot(centre.normalized()) < 0.6) continue;
    Vec2 corners[4];
    bool inside = true;
    for (int k = 0; k < 4; ++k) {
      const auto pixel = lens.project(camera_from_world * Vec3(tag.corner_C(k) + dive.cave->origin_W));
      inside = inside && pixel && lens.contains(*pixel, 20.0);
      if (inside) corners[k] = *pixel;
    }
    if (!inside) continue;
    const double size_px = (corners[0] - corners[2]).norm();
    if (size_px > largest_px) {
      largest_px = size_px;
      best_s = t;
    }
  }
  return best_s;
}

TEST(LineTags, AreFoundInImagesWhereTheTruthSaysTheyAre) {
  const Dive dive = makeDive(caveOf("two_entrances", 1, 1, "clean", 6));
  ASSERT_EQ(dive.cave->tags.size(), 6u);
  CaveOptions options;
  options.max_triangles = 400'000;
  const auto world = buildCaveWorld(dive.cave->layout, options, dive.cave->tags, dive.cave->origin_W);
  const ImageRenderer renderer(world, dive.errors.truth.rig, renderSettings(dive));
  const WorldFromBodyAt motion = [&](double t) { return dive.motion.at(std::max(t, 0.0)).world_from_body; };
  const auto lens = makeCamera(dive.errors.in_water.cameras[0]);
  int seen = 0, found = 0;
  std::vector<double> errors_px;
  for (const LineTag& tag : dive.cave->tags) {
    const double time_s = bestViewOf(dive, tag, *lens);
    if (time_s < 0.0) continue;
    ++seen;
    auto tags = foundTags(renderer.render(0, motion, time_s));
    if (tags.count(tag.id) == 0) continue;
    ++found;
    const Rigid3 camera_from_world =
        (motion(time_s) * dive.errors.truth.rig.cameras[0].body_from_camera).inverse();
    Vec2 off_px = Vec2::Zero();
    for (int k = 0; k < 4; ++k) {
      const Vec2 truth_px = *lens->project(camera_from_world * Vec3(tag.corner_C(k) + dive.cave->origin_W));
      const Vec2 error_px = tags[tag.id][static_cast<size_t>(k)] - truth_px;
      errors_px.push_back(error_px.norm());
      // Next to a lamp, the bright plate spills over the black square.
      EXPECT_LT(error_px.norm(), 0.03 * (tags[tag.id][0] - tags[tag.id][2]).norm()) << tag.id;
      off_px += 0.25 * error_px;
    }
    EXPECT_LT(off_px.norm(), 0.35) << tag.id;
  }
  EXPECT_GE(seen, 3);
  EXPECT_GE(found, seen - 1);
  ASSERT_FALSE(errors_px.empty());
  std::sort(errors_px.begin(), errors_px.end());
  EXPECT_LT(errors_px[errors_px.size() / 2], 0.6);
}

TEST(LineTags, HangInTheSamePlacesInEveryDive) {
  const Dive first = makeDive(caveOf("loop_cave", 2, 1, "clean", 8)),
             second = makeDive(caveOf("loop_cave", 2, 7, "clean", 8));
  for (size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(first.cave->tags[i].id, static_cast<int>(i));
    EXPECT_EQ(first.cave->tags[i].cave_from_tag.matrix(), second.cave->tags[i].cave_from_tag.matrix());
    EXPECT_NEAR((first.cave->tags[i].corner_C(1) - first.cave->tags[i].corner_C(0)).norm(), 0.15, 1e-12);
  }
}

TEST(LineTags, AreInTheTruthInTheFrameOfTheCave) {
  ScenarioChanges changes;
  changes.tags = 2;
  changes.no_images = true;
  changes.metres = 6.0;
  changes.dive_seed = 4;
  const Scenario scenario = makeScenario("demo", changes);
  const auto folder = std::filesystem::temp_directory_path() / ("lodeline_tags_" + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  recordScenario(scenario, folder, {});
  const Dive dive = makeDive(scenario);
  std::ifstream tags(folder / "truth" / "tags.csv");
  std::string header, line;
  std::getline(tags, header);
  EXPECT_EQ(header.substr(0, 34), "#tag,size [m],centre_x [m],centre_");
  int rows = 0;
  for (; std::getline(tags, line); ++rows) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream stream(line);
    double id = 0.0, size_m = 0.0, v[15];
    stream >> id >> size_m;
    for (double& value : v) stream >> value;
    ASSERT_TRUE(stream);
    const LineTag& tag = dive.cave->tags[static_cast<size_t>(rows)];
    EXPECT_EQ(id, tag.id);
    for (int k = 0; k < 4; ++k)
      EXPECT_LT((Vec3(v[3 * k + 3], v[3 * k + 4], v[3 * k + 5]) - tag.corner_C(k)).norm(), 2e-6);
  }
  EXPECT_EQ(rows, 2);
  std::ostringstream cave;
  cave << std::ifstream(folder / "truth" / "cave.yaml").rdbuf();
  EXPECT_NE(cave.str().find("cave_seed: 1\ndive_seed: 4\n"), std::string::npos);
  EXPECT_NE(cave.str().find("world_from_cave_m: ["), std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lodeline
