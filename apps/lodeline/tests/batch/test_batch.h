#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/types.h>

#include <set>
#include <string>
#include <vector>

#include "apps/lodeline/tests/test_program.h"
#include "apps/lodeline/tests/test_recording.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline::test {

inline constexpr int kBatchRecordings = 5;

/// Tests of `lodeline batch` on five recordings of a room.
class BatchTest : public testing::Test {
 protected:
  BatchTest();

  /// A list of all recordings with their truth, `more` after it.
  std::filesystem::path writeList(const std::string& more = "") const;
  Execution batch(const std::string& options = "") const;
  /// Starts a worker in the background, whose messages go to `log`.
  pid_t startWorker(const std::string& log, const std::vector<std::string>& options = {}) const;
  std::filesystem::path recording(int number) const;
  /// Replaces the links of a recording by copies of the files, which a test can change.
  void copyRecording(int number) const;
  /// Waits up to a minute for so many results.
  void waitForResults(size_t count) const;
  /// Waits for the end of a worker; its exit code, or -1 where a signal ended it.
  static int waitFor(pid_t worker);

  /// Names in a folder of the output; none where it is missing.
  std::set<std::string> names(const std::string& folder) const;
  /// Number of items that the messages of a worker call done.
  static int made(const std::string& messages);
  void expectNothingLeftOver() const;

  TemporaryFolder folder_;
  std::filesystem::path list_, output_;
};

}  // namespace lodeline::test
