#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "apps/lodeline/batch/item_claim.h"
#include "apps/lodeline/tests/batch/test_batch.h"

// Tests of several processes that work on one batch, and of the locks between them.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class BatchWorkers : public BatchTest {
 protected:
  std::string log(const std::string& name) const { return readText(folder_.path() / name); }
};

TEST_F(BatchWorkers, AKilledWorkerLosesNothingAndAnotherTakesOver) {
  const pid_t killed = startWorker("killed.log");
  waitForResults(2);
  const pid_t other = startWorker("other.log");  // it waits for the item of the first, and takes it over
  waitForResults(3);
  kill(killed, SIGKILL);
  EXPECT_EQ(waitFor(killed), -1);
  EXPECT_EQ(waitFor(other), 0) << log("other.log");
  EXPECT_THAT(names("results"), SizeIs(kBatchRecordings));
  EXPECT_LE(made(log("killed.log")), kBatchRecordings - 1);
  EXPECT_LE(made(log("killed.log")) + made(log("other.log")), kBatchRecordings);
  EXPECT_THAT(batch().output, HasSubstr("made 0, kept 5, failed 0"));
  expectNothingLeftOver();
}

TEST_F(BatchWorkers, TwoAtOnceMakeEachItemOnce) {
  const pid_t first = startWorker("first.log");
  const pid_t second = startWorker("second.log");
  EXPECT_EQ(waitFor(first), 0) << log("first.log");
  EXPECT_EQ(waitFor(second), 0) << log("second.log");
  EXPECT_EQ(made(log("first.log")) + made(log("second.log")), kBatchRecordings);
  EXPECT_GT(made(log("first.log")), 0);
  EXPECT_GT(made(log("second.log")), 0);
  std::string records;
  for (const std::string& worker : names("workers")) records += readText(output_ / "workers" / worker);
  for (int i = 0; i < kBatchRecordings; ++i) {
    for (const char* event : {"started", "done"}) {
      const std::string record = fmt::format(",dive{}.default,{}\n", i, event);
      EXPECT_NE(records.find(record), std::string::npos) << records;
      EXPECT_EQ(records.find(record), records.rfind(record)) << records;
    }
  }
  EXPECT_THAT(names("results"), SizeIs(kBatchRecordings));
  expectNothingLeftOver();
}

TEST_F(BatchWorkers, ShardsCoverEachItemOnce) {
  int total = 0;
  for (int shard = 1; shard <= 3; ++shard) {
    const Execution result = batch(fmt::format("--shard {}/3", shard));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    total += made(result.output);
  }
  EXPECT_EQ(total, kBatchRecordings);
  EXPECT_THAT(names("results"), SizeIs(kBatchRecordings));
}

TEST_F(BatchWorkers, TerminationEndsTheChildrenAndReleasesTheLocks) {
  const pid_t worker = startWorker("worker.log", {"--jobs", "2"});
  waitForResults(1);
  kill(worker, SIGTERM);
  EXPECT_EQ(waitFor(worker), 130) << log("worker.log");
  expectNothingLeftOver();
  EXPECT_THAT(names("failed"), IsEmpty());
  const size_t finished = names("results").size();
  EXPECT_LT(finished, static_cast<size_t>(kBatchRecordings));
  EXPECT_THAT(batch().output, HasSubstr(fmt::format("kept {}, failed 0", finished)));
}

class ItemClaimTest : public testing::Test {
 protected:
  std::filesystem::path lock() const { return folder_.path() / "lock"; }

  /// Number of processes that get the item when all try at once; all live until the last has tried.
  int ownersAmong(int processes) const {
    int answers[2];
    int gate[2];
    if (pipe(answers) != 0 || pipe(gate) != 0) return -1;
    std::vector<pid_t> children;
    for (int i = 0; i < processes; ++i) {
      children.push_back(fork());
      if (children.back() != 0) continue;
      close(gate[1]);
      const char has_it = ItemClaim::take(lock(), 600.0).release() != nullptr ? 1 : 0;
      char end = 0;
      const bool is_sent = write(answers[1], &has_it, 1) == 1;
      _exit(is_sent && read(gate[0], &end, 1) == 0 ? 0 : 1);  // returns when the gate closes
    }
    int owners = 0;
    for (int i = 0; i < processes; ++i) {
      char has_it = 0;
      if (read(answers[0], &has_it, 1) == 1) owners += has_it;
    }
    for (const int descriptor : {answers[0], answers[1], gate[0], gate[1]}) close(descriptor);
    for (const pid_t child : children) waitpid(child, nullptr, 0);
    return owners;
  }

  TemporaryFolder folder_;
};

TEST_F(ItemClaimTest, OneHoldsItUntilItLetsGo) {
  auto claim = ItemClaim::take(lock(), 600.0);
  ASSERT_TRUE(claim);
  EXPECT_FALSE(ItemClaim::take(lock(), 600.0));
  claim.reset();
  EXPECT_FALSE(std::filesystem::exists(lock()));
  EXPECT_TRUE(ItemClaim::take(lock(), 600.0));
}

TEST_F(ItemClaimTest, ADeadProcessOfThisMachineLosesItAtOnce) {
  const pid_t child = fork();
  if (child == 0) {
    (void)ItemClaim::take(lock(), 600.0).release();  // leaves the lock, as a killed process does
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(std::filesystem::exists(lock() / "1"));
  const auto claim = ItemClaim::take(lock(), 600.0);
  EXPECT_TRUE(claim);
  EXPECT_FALSE(ItemClaim::take(lock(), 600.0));
}

TEST_F(ItemClaimTest, AnotherMachineLosesItWhenItsLockIsOld) {
  folder_.write("lock/4", R"({"host":"far","pid":1,"start":"1","space":"far"})");
  EXPECT_FALSE(ItemClaim::take(lock(), 600.0));
  const auto old = std::filesystem::last_write_time(lock() / "4") - std::chrono::seconds(700);
  std::filesystem::last_write_time(lock() / "4", old);
  auto claim = ItemClaim::take(lock(), 600.0);
  ASSERT_TRUE(claim);
  claim.reset();
  EXPECT_FALSE(std::filesystem::exists(lock()));
}

TEST_F(ItemClaimTest, AHalfWrittenLockCountsUntilItIsOld) {
  folder_.write("lock/1", "{\"host\":");
  EXPECT_FALSE(ItemClaim::take(lock(), 600.0));
  EXPECT_TRUE(ItemClaim::take(lock(), 0.0));
}

TEST_F(ItemClaimTest, OfManyProcessesOneGetsAStaleItem) {
  for (int round = 0; round < 20; ++round) {
    folder_.write("lock/1", R"({"host":"far","pid":1,"start":"1","space":"far"})");
    std::filesystem::last_write_time(
        lock() / "1", std::filesystem::file_time_type::clock::now() - std::chrono::seconds(700));
    EXPECT_EQ(ownersAmong(8), 1);
    std::filesystem::remove_all(lock());
  }
}

}  // namespace
}  // namespace lodeline::test
