#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/map_rows.h"
#include "lodeline/mapping/store/sqlite/database.h"
#include "lodeline/mapping/store/test_map.h"

// Tests of maps that are killed, locked, full, read-only or no maps at all.

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MapAccessTest : public ::testing::Test {
 protected:
  std::filesystem::path path(const char* name = "cave.db") const { return folder_.path() / name; }
  std::string openError(MapFile::Access access = MapFile::Access::Change) const {
    try {
      MapFile::open(path(), access);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
};

/// Runs `work` in another process and returns what it returns.
int inOtherProcess(const std::function<int()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 99;
    try {
      code = work();
    } catch (const std::exception& error) {
      fprintf(stderr, "%s\n", error.what());
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool failsWith(const std::function<void()>& work, const char* words) {
  try {
    work();
  } catch (const InputError& error) {
    if (std::string(error.what()).find(words) != std::string::npos) return true;
    fprintf(stderr, "%s\n", error.what());
  }
  return false;
}

/// Adds dives 0, 1, 2, ... of `number` % 4 + 1 keyframes without end. After each commit, one byte to `done`.
[[noreturn]] void addDivesForEver(const std::filesystem::path& file, int done) {
  std::mt19937 random(3);
  MapFile map = MapFile::openOrCreate(file, {});
  for (int number = static_cast<int>(map.dives().size());; ++number) {
    MapChange change = map.change();
    const DiveId dive = change.addDive(test::namedDive(std::to_string(number)));
    for (int i = 0; i <= number % 4; ++i) change.addKeyframe(test::passageKeyframe(dive, i, 30, &random));
    change.commit();
    if (write(done, "x", 1) != 1) _exit(1);
  }
}

/// Number of bytes in a pipe until its end.
int countOf(int pipe_end) {
  int count = 0;
  char buffer[4096];
  for (ssize_t size = 0; (size = read(pipe_end, buffer, sizeof buffer)) > 0;) count += static_cast<int>(size);
  return count;
}

/// Starts a writer, kills it after some time, and returns how many dives it said it had committed.
int killAWriter(const std::filesystem::path& file, std::chrono::microseconds delay) {
  int ends[2];
  if (pipe(ends) != 0) return -1;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    try {
      addDivesForEver(file, ends[1]);
    } catch (const std::exception& error) {
      fprintf(stderr, "%s\n", error.what());
    }
    _exit(1);
  }
  close(ends[1]);
  std::this_thread::sleep_for(delay);
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  const int committed = countOf(ends[0]);
  close(ends[0]);
  return WIFSIGNALED(status) ? committed : -1;
}

TEST_F(MapAccessTest, AKillLeavesTheMapOfBeforeOrAfter) {
  std::mt19937 random(17);
  int committed = 0;
  for (int round = 0; round < 100; ++round) {
    if (round % 10 == 0) {  // a new map, so that creation is interrupted too
      for (const char* name : {"cave.db", "cave.db-wal", "cave.db-shm"}) std::filesystem::remove(path(name));
      committed = 0;
    }
    const int microseconds = static_cast<int>(random() % (round % 2 == 0 ? 8000 : 60000));
    const int said = killAWriter(path(), std::chrono::microseconds(microseconds));
    ASSERT_GE(said, 0);
    if (isUnfinishedMap(path())) {
      ASSERT_EQ(committed + said, 0);
      continue;
    }
    const MapFile map = MapFile::open(path(), MapFile::Access::Read);
    ASSERT_THAT(map.check(), IsEmpty()) << "round " << round;
    const std::vector<MapDive> dives = map.dives();
    const int count = static_cast<int>(dives.size());
    // The last commit may have ended before the writer could say so.
    ASSERT_GE(count, committed + said);
    ASSERT_LE(count, committed + said + 1);
    for (int number = 0; number < count; ++number) {
      ASSERT_EQ(dives[static_cast<size_t>(number)].name, std::to_string(number));
      int keyframes = 0;
      map.forEachKeyframe(dives[static_cast<size_t>(number)].id, [&](const StoredKeyframe&) { ++keyframes; });
      ASSERT_EQ(keyframes, number % 4 + 1);
    }
    committed = count;
  }
}

TEST_F(MapAccessTest, OtherFilesAreNamed) {
  EXPECT_THAT(openError(), HasSubstr("there is no such file"));
  std::ofstream(path()) << std::string(5000, 'a');
  EXPECT_THAT(openError(), HasSubstr("cave.db: is no map"));
  EXPECT_THROW(MapFile::openOrCreate(path(), {}), InputError);
  EXPECT_THROW(MapFile::create(path(), {}), InputError);
  EXPECT_EQ(std::filesystem::file_size(path()), 5000u) << "a file of the user stays as it is";
  std::filesystem::remove(path());
  {
    Database other(path(), Database::Mode::Create);
    other.run("CREATE TABLE photographs (id INTEGER)");
  }
  EXPECT_THAT(openError(), HasSubstr("is a database of another program"));
  EXPECT_THROW(MapFile::create(path(), {}), InputError);
  std::filesystem::remove(path());
  std::filesystem::create_directory(path());
  EXPECT_THAT(openError(), HasSubstr("is a folder"));
  EXPECT_THROW(MapFile::openOrCreate(path(), {}), InputError);
}

TEST_F(MapAccessTest, OtherVersionsAreNamed) {
  MapFile::create(path(), {});
  const auto setVersion = [&](const char* sql) { Database(path(), Database::Mode::Change).run(sql); };
  setVersion("PRAGMA user_version = 7");
  EXPECT_THAT(openError(), HasSubstr("is a map of version 7, and this program knows maps up to version 2"));
  EXPECT_THAT(openError(MapFile::Access::Read), HasSubstr("use a newer program"));
  setVersion("PRAGMA user_version = 0");
  EXPECT_THAT(openError(), HasSubstr("is a map of version 0, older"));
}

// A map of version 1 has no table of fields.
TEST_F(MapAccessTest, AMapOfVersion1IsReadAndCanBeExtended) {
  std::mt19937 random(1);
  const auto extend = [&](const char* name) {
    MapFile map = MapFile::openOrCreate(path(), {});
    MapChange change = map.change();
    const DiveId dive = change.addDive(test::namedDive(name));
    const KeyframeId id = change.addKeyframe(test::passageKeyframe(dive, 1, 2, &random));
    change.commit();
    return id;
  };
  const KeyframeId first = extend("a");
  Database(path(), Database::Mode::Change).run("DROP TABLE field; PRAGMA user_version = 1");
  for (int time = 0; time < 2; ++time) {
    const MapFile map = MapFile::open(path(), MapFile::Access::Read);
    EXPECT_FALSE(map.keyframe(first)->keyframe.field);
    EXPECT_EQ(map.fullKeyframe(first).features.size(), 2u);
    EXPECT_TRUE(map.check().empty());
  }
  EXPECT_EQ(Database(path(), Database::Mode::Read).number("PRAGMA user_version"), 1)
      << "reading changes nothing";
  std::filesystem::permissions(path(), std::filesystem::perms::owner_read);
  EXPECT_FALSE(MapFile::open(path(), MapFile::Access::Read).keyframe(first)->keyframe.field);
  std::filesystem::permissions(path(), std::filesystem::perms::owner_all);

  const KeyframeId second = extend("b");
  MapFile map = MapFile::open(path(), MapFile::Access::Change);
  EXPECT_FALSE(map.keyframe(first)->keyframe.field);
  EXPECT_TRUE(map.keyframe(second)->keyframe.field);
  EXPECT_EQ(Database(path(), Database::Mode::Read).number("PRAGMA user_version"), 2);
  EXPECT_TRUE(map.check().empty());
  MapChange change = map.change();
  change.removeDive(map.findDive("b")->id);
  change.commit();
  EXPECT_EQ(Database(path(), Database::Mode::Read).number("SELECT count(*) FROM field"), 0);
}

TEST_F(MapAccessTest, ALockedMapIsNamed) {
  MapFile map = MapFile::create(path(), {});
  const MapChange open_change = map.change();
  MapFile other = MapFile::open(path(), MapFile::Access::Change);
  EXPECT_TRUE(failsWith([&] { other.change(); }, "another program is changing this map"));
  EXPECT_TRUE(MapFile::open(path(), MapFile::Access::Read).dives().empty());
}

TEST_F(MapAccessTest, AReadOnlyMapCanBeReadAndNotChanged) {
  std::mt19937 random(1);
  {
    MapFile map = MapFile::create(path(), {});
    MapChange change = map.change();
    change.addDive(test::namedDive("a"));
    change.commit();
  }
  std::filesystem::permissions(path(), std::filesystem::perms(0444));
  std::filesystem::permissions(folder_.path(), std::filesystem::perms(0555));
  const int code = inOtherProcess([&] {
    if (geteuid() == 0 && setuid(65534) != 0) return 2;
    if (!failsWith([&] { MapFile::open(path(), MapFile::Access::Change); }, "lack of write permission"))
      return 3;
    return MapFile::open(path(), MapFile::Access::Read).dives().size() == 1 ? 0 : 4;
  });
  std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
  EXPECT_EQ(code, 0);
  EXPECT_TRUE(failsWith(
      [&] {
        MapFile map = MapFile::open(path(), MapFile::Access::Read);
        map.change();
      },
      "cannot be changed"));
}

TEST_F(MapAccessTest, AFullDiskLeavesTheMapOfBefore) {
  MapFile::create(path(), {});
  const int code = inOtherProcess([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit most{300000, 300000};
    setrlimit(RLIMIT_FSIZE, &most);
    std::mt19937 random(1);
    MapFile map = MapFile::open(path(), MapFile::Access::Change);
    return failsWith(
               [&] {
                 MapChange change = map.change();
                 const DiveId dive = change.addDive(test::namedDive("long"));
                 for (int i = 0; i < 500; ++i)
                   change.addKeyframe(test::passageKeyframe(dive, i, 200, &random));
                 change.commit();
               },
               "is the disk full?")
               ? 0
               : 1;
  });
  EXPECT_EQ(code, 0);
  const MapFile map = MapFile::open(path(), MapFile::Access::Read);
  EXPECT_THAT(map.dives(), IsEmpty());
  EXPECT_THAT(map.check(), IsEmpty());
}

TEST_F(MapAccessTest, NamesOfFilesMayHoldAnyCharacter) {
  MapFile::create(path("50% #1?mode=ro.db"), {});
  EXPECT_TRUE(std::filesystem::exists(path("50% #1?mode=ro.db")));
  EXPECT_TRUE(MapFile::open(path("50% #1?mode=ro.db"), MapFile::Access::Read).dives().empty());
}

}  // namespace
}  // namespace lodeline
