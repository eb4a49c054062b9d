#include "lodeline/mapping/recognition/descriptor_index.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/recognition/test_loop_scene.h"

namespace lodeline {
namespace {

/// Keyframes of 60 different places, 80 features each.
class Places : public testing::Test {
 protected:
  static constexpr int kPlaces = 60;
  SceneMaker maker_{5};
  std::vector<std::vector<ScenePoint>> scenes_;
  DescriptorIndex index_;

  void SetUp() override {
    for (int i = 0; i < kPlaces; ++i) {
      scenes_.push_back(maker_.points(80));
      MapKeyframe keyframe = maker_.keyframe(scenes_.back(), Rigid3());
      keyframe.dive = i % 2;
      index_.add(keyframe);
    }
  }
  /// Another visit of a place, of which 24 points are seen again.
  MapKeyframe revisit(size_t place) {
    std::vector<ScenePoint> seen(scenes_[place].begin(), scenes_[place].begin() + 24);
    for (const ScenePoint& other : maker_.points(56)) seen.push_back(other);
    return maker_.keyframe(seen, Rigid3());
  }
};

TEST_F(Places, AreFoundAgain) {
  for (size_t place = 0; place < kPlaces; ++place) {
    const auto found = index_.query(revisit(place), 3);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().id, static_cast<KeyframeId>(place));
    EXPECT_GE(found.front().votes, 8);
    EXPECT_LE(found.size(), 3u);
    for (size_t i = 1; i < found.size(); ++i) EXPECT_GE(found[i - 1].score, found[i].score);
  }
}

TEST_F(Places, AreLeftOutOnRequest) {
  for (const SimilarKeyframe& similar : index_.query(revisit(7), 10, [](KeyframeId id) { return id == 7; }))
    EXPECT_NE(similar.id, 7);
}

TEST_F(Places, OfARemovedDiveAreGone) {
  index_.removeDive(1);
  EXPECT_EQ(index_.size(), 30u);
  for (const SimilarKeyframe& similar : index_.query(revisit(7), 10)) EXPECT_EQ(similar.id % 2, 0);
  EXPECT_EQ(index_.query(revisit(8), 1).front().id, 8);
  MapKeyframe again = revisit(7);
  again.id = 7;
  index_.add(again);
  EXPECT_EQ(index_.query(again, 1).front().id, 7);
}

TEST_F(Places, HaveAnIdEach) {
  MapKeyframe keyframe = revisit(3);
  keyframe.id = 3;
  EXPECT_THROW(index_.add(keyframe), InputError);
  keyframe.id = -1;
  EXPECT_THROW(index_.add(keyframe), InputError);
}

TEST(DescriptorIndex, IsSearchedWhileEmpty) {
  SceneMaker maker(6);
  const DescriptorIndex index;
  EXPECT_TRUE(index.query(maker.keyframe(maker.points(10), Rigid3()), 5).empty());
}

TEST(DescriptorIndex, TakesManyEqualDescriptors) {
  SceneMaker maker(7);
  auto points = maker.points(300);
  for (ScenePoint& point : points) point.look = points.front().look;
  SceneErrors exact;
  exact.flipped_bits = 0;
  DescriptorIndex index({.features_per_keyframe = 300});
  for (int i = 0; i < 3; ++i) index.add(maker.keyframe(points, Rigid3(), exact));
  const auto found = index.query(maker.keyframe(points, Rigid3(), exact), 5);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].id, 0) << "lowest id among equals";
  EXPECT_EQ(found[0].votes, 300) << "a feature votes once";
}

TEST(DescriptorIndex, RefusesUselessOptions) {
  EXPECT_THROW(DescriptorIndex({.features_per_keyframe = 0}), UsageError);
  EXPECT_THROW(DescriptorIndex({.max_distance = -1}), UsageError);
}

}  // namespace
}  // namespace lodeline
