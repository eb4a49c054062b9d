#include "lodeline/output/survey/map/export_owner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/map/test_dive.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

DiveMap mapOf(const std::string& run_folder, int64_t later_ns) {
  RunFolder run = test::windingDive();
  run.folder = run_folder;
  for (StampedPose& pose : run.trajectory.poses)
    pose.time = Time::fromNanoseconds(pose.time.nanoseconds() + later_ns);
  DiveMapOptions options;
  options.name = "out";
  Diagnostics diagnostics;
  return makeDiveMap(run, options, {}, &diagnostics);
}

TEST(ExportOwner, LetsADiveReplaceItsOwnFiles) {
  const test::TemporaryFolder folder;
  const DiveMap map = mapOf("/monday/out", 0);
  expectOwnFiles(folder.path(), map, {"out.svx"});
  folder.write("out.svx", "");
  folder.write(notesFileName("out"), notesText(map));
  expectOwnFiles(folder.path(), map, {"out.svx"});
  expectOwnFiles(folder.path(), mapOf("/monday/out", 1000), {"out.svx"});  // run anew
  expectOwnFiles(folder.path(), mapOf("/moved/out", 0), {"out.svx"});
}

TEST(ExportOwner, KeepsTheFilesOfOthers) {
  const test::TemporaryFolder folder;
  const DiveMap map = mapOf("/tuesday/out", 1000);
  folder.write(notesFileName("out"), notesText(mapOf("/monday/out", 0)));
  EXPECT_THAT([&] { expectOwnFiles(folder.path(), map, {"out.kml"}); },
              ThrowsMessage<UsageError>(HasSubstr("/monday/out")));
  const test::TemporaryFolder by_hand;
  by_hand.write("out.svx", "*begin out\n");
  EXPECT_THAT([&] { expectOwnFiles(by_hand.path(), map, {"out.svx"}); },
              ThrowsMessage<UsageError>(HasSubstr("--overwrite")));
}

}  // namespace
}  // namespace lodeline
