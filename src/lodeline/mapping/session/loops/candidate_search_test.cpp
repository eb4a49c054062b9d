#include "lodeline/mapping/session/loops/candidate_search.h"

#include <gtest/gtest.h>

#include "lodeline/mapping/recognition/test_loop_scene.h"

namespace lodeline {
namespace {

/// Number of candidates for a keyframe that sees what a keyframe of an earlier dive sees, by their depths.
size_t candidatesAt(const ScalarPrior& old_depth_m, const ScalarPrior& new_depth_m) {
  SceneMaker maker(5);
  const std::vector<ScenePoint> points = maker.points(60);
  DivePlacement unknown;
  unknown.is_known = false;
  KnownKeyframes known;
  DescriptorIndex index;
  MapKeyframe newest;
  for (const int dive : {1, 2}) {
    newest = maker.keyframe(points, Rigid3());
    newest.id = dive;
    newest.dive = dive;
    newest.depth_m = dive == 1 ? old_depth_m : new_depth_m;
    known.startDive(dive, unknown);
    known.add(knownOf(newest, Rigid3(), 0.0), nullptr);
    if (dive == 1) index.add(newest);
  }
  return CandidateSearch(CandidateSearchOptions{}).find(newest, known, index).size();
}

TEST(CandidateSearch, LeavesOutPlacesAtAnotherDepth) {
  EXPECT_EQ(candidatesAt({100.0, 0.1}, {100.5, 0.1}), 1u);
  EXPECT_EQ(candidatesAt({100.0, 0.1}, {103.0, 0.1}), 0u);
}

TEST(CandidateSearch, AllowsForTheErrorsOfDeepDepths) {
  // At 100 m, a density known to 1 % leaves 1 m.
  EXPECT_EQ(candidatesAt({100.0, 1.0}, {103.0, 1.0}), 1u);
  EXPECT_EQ(candidatesAt({100.0, 1.0}, {110.0, 1.0}), 0u);
}

}  // namespace
}  // namespace lodeline
