#include "lodeline/batch/loops/loop_links.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/trials/scene.h"

namespace lodeline {
namespace {

Time linkTime(double seconds) {
  return Time::fromNanoseconds(5'000'000'000) + Duration::fromSeconds(seconds);
}

/// States at 0, 1, ..., 9 s. Track 7 has the pieces 0 (states 0 to 2) and 1 (3 to 5), track 8 the piece 2
/// (state 8).
struct LinkedTracks {
  std::vector<std::shared_ptr<const Camera>> cameras;
  LoopLinker linker;
  Tracks pieces;

  LinkedTracks() : linker(times()) {
    for (const CameraCalibration& camera : testRig(2).cameras) cameras.push_back(makeCamera(camera));
    for (size_t k = 0; k < 6; ++k) linker.add(7, k < 3 ? 0 : 1, k);
    linker.add(8, 2, 8);
    for (TrackId piece = 0; piece < 3; ++piece) pieces[piece].observations.resize(2);
  }
  static std::vector<Time> times() {
    std::vector<Time> times;
    for (int k = 0; k < 10; ++k) times.push_back(linkTime(k));
    return times;
  }
  static LoopObservation loop(TrackId old_track, double old_s, double new_s, TrackId new_track) {
    LoopObservation loop{old_track, linkTime(old_s), linkTime(new_s), {}};
    loop.observation.track = new_track;
    return loop;
  }
  std::vector<LoopLink> link(const std::vector<LoopObservation>& loops) {
    return linker.link(loops, cameras, &pieces);
  }
};

TEST(LoopLinks, ConnectThePiecesThatContainTheTimes) {
  LinkedTracks tracks;
  const auto links = tracks.link({LinkedTracks::loop(7, 1.0, 8.0, 8), LinkedTracks::loop(7, 4.2, 8.3, 8),
                                  LinkedTracks::loop(7, 4.0, 8.0, 8)});
  ASSERT_EQ(links.size(), 2u);
  EXPECT_EQ(links[0].older, 1);
  EXPECT_EQ(links[0].newer, 2);
  EXPECT_EQ(links[0].votes, 2);
  EXPECT_EQ(links[1].older, 0);
  EXPECT_EQ(links[1].votes, 1);
}

TEST(LoopLinks, MakeAPieceOfACornerThatWasNotTracked) {
  LinkedTracks tracks;
  const auto links = tracks.link({LinkedTracks::loop(7, 1.0, 6.0, -1), LinkedTracks::loop(8, 8.0, 6.0, -1)});
  ASSERT_EQ(links.size(), 2u);
  EXPECT_EQ(links[0].newer, 3);
  EXPECT_EQ(links[1].newer, 3) << "one observation, matched twice";
  ASSERT_EQ(tracks.pieces.at(3).observations.size(), 1u);
  EXPECT_EQ(tracks.pieces.at(3).observations.front().frame, 6);
}

TEST(LoopLinks, LeaveOutWhatTheRecordDoesNotHave) {
  LinkedTracks tracks;
  EXPECT_TRUE(tracks
                  .link({LinkedTracks::loop(9, 1.0, 8.0, 8), LinkedTracks::loop(7, 1.0, 8.0, 9),
                         LinkedTracks::loop(7, 1.0, 6.5, -1), LinkedTracks::loop(7, 1.0, 2.0, 7),
                         LinkedTracks::loop(-1, 1.0, 6.0, -1)})
                  .empty());
  EXPECT_EQ(tracks.pieces.size(), 3u);
}

TEST(LoopLinks, RefuseObservationsThatAreNone) {
  LinkedTracks tracks;
  LoopObservation loop = LinkedTracks::loop(7, 1.0, 6.0, -1);
  loop.observation.camera = 2;
  EXPECT_THROW(tracks.link({loop}), InputError);
  loop.observation.camera = 0;
  loop.observation.bearing_C = Vec3::Zero();
  EXPECT_THROW(tracks.link({loop}), InputError);
  loop.observation.bearing_C = Vec3::UnitZ();
  loop.observation.sigma_px = 0.0;
  EXPECT_THROW(tracks.link({loop}), InputError);
}

}  // namespace
}  // namespace lodeline
