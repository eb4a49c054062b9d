#include "apps/lodeline/tests/batch/test_batch.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace lodeline::test {

namespace fs = std::filesystem;

namespace {

/// One recording for all tests, since making it takes longer than most of them.
const RoomRecording& sharedRoom() {
  static const TemporaryFolder folder;
  static const RoomRecording room = writeRoomRecording(folder.path());
  return room;
}

}  // namespace

BatchTest::BatchTest() : list_(folder_.path() / "list.yaml"), output_(folder_.path() / "out") {
  fs::copy_file(sharedRoom().truth, folder_.path() / "truth.tum");
  for (int i = 0; i < kBatchRecordings; ++i) fs::create_directory_symlink(sharedRoom().data, recording(i));
  writeList();
}

void BatchTest::copyRecording(int number) const {
  fs::remove(recording(number));
  fs::copy(sharedRoom().data, recording(number), fs::copy_options::recursive);
}

fs::path BatchTest::recording(int number) const { return folder_.path() / fmt::format("dive{}", number); }

fs::path BatchTest::writeList(const std::string& more) const {
  std::string text = "args: --no-report --set source.duration_s=0.6\nrecordings:\n";
  for (int i = 0; i < kBatchRecordings; ++i)
    text += fmt::format("  - {{data: dive{}, truth: truth.tum}}\n", i);
  return folder_.write("list.yaml", text + more);
}

Execution BatchTest::batch(const std::string& options) const {
  return runProgram(fmt::format("batch {} -o {} {}", quoted(list_), quoted(output_), options));
}

pid_t BatchTest::startWorker(const std::string& log, const std::vector<std::string>& options) const {
  const std::string program = programPath();
  const std::string file = folder_.path() / log;
  std::vector<std::string> words = {program, "batch", list_, "-o", output_};
  words.insert(words.end(), options.begin(), options.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t worker = fork();
  if (worker == 0) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    dup2(descriptor, STDOUT_FILENO);
    dup2(descriptor, STDERR_FILENO);
    execv(program.c_str(), pointers.data());
    _exit(127);
  }
  return worker;
}

void BatchTest::waitForResults(size_t count) const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (names("results").size() < count && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

int BatchTest::waitFor(pid_t worker) {
  int status = 0;
  waitpid(worker, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::set<std::string> BatchTest::names(const std::string& folder) const {
  std::set<std::string> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(output_ / folder, ignored)) {
    found.insert(entry.path().filename().string());
  }
  return found;
}

int BatchTest::made(const std::string& messages) {
  int count = 0;
  const std::string event = " done\n";
  for (size_t at = messages.find(event); at != std::string::npos; at = messages.find(event, at + 1)) ++count;
  return count;
}

void BatchTest::expectNothingLeftOver() const {
  EXPECT_THAT(names(".locks"), testing::IsEmpty());
  EXPECT_THAT(names(".work"), testing::IsEmpty());
}

}  // namespace lodeline::test
