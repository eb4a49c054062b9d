#include "apps/lodeline/batch/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <stdexcept>
#include <thread>

namespace lodeline {
namespace {

constexpr int kSignalBase = 128;   ///< of exit codes, as in shells
constexpr int kCannotStart = 127;  ///< exit code, as in shells

bool redirect(int descriptor, const char* file, int flags) {
  const int opened = open(file, flags, 0666);
  return opened >= 0 && dup2(opened, descriptor) >= 0;
}

/// The part that runs in the new process. It calls only functions that are safe after fork().
[[noreturn]] void becomeChild(const char* folder, const char* output, const char* errors, char** words,
                              pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kCannotStart);  // the parent died before
  constexpr int kWrite = O_WRONLY | O_CREAT | O_TRUNC;
  if (!redirect(STDERR_FILENO, errors, kWrite) || !redirect(STDOUT_FILENO, output, kWrite) ||
      !redirect(STDIN_FILENO, "/dev/null", O_RDONLY) || chdir(folder) != 0) {
    _exit(kCannotStart);
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  execv("/proc/self/exe", words);
  _exit(kCannotStart);
}

}  // namespace

pid_t startChild(const ChildCommand& command) {
  std::vector<std::string> words = command.words;
  words.insert(words.begin(), "lodeline");
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no further process can be started");
  if (child == 0) {
    becomeChild(command.folder.c_str(), command.output.c_str(), command.errors.c_str(), pointers.data(),
                parent);
  }
  return child;
}

std::optional<int> exitOfChild(pid_t child) {
  int status = 0;
  const pid_t ended = waitpid(child, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return std::nullopt;
  if (ended < 0) return kCannotStart;
  return WIFEXITED(status) ? WEXITSTATUS(status) : kSignalBase + WTERMSIG(status);
}

void endChildren(const std::vector<pid_t>& children) {
  constexpr int kPatienceSteps = 250;  // of 20 ms
  for (const pid_t child : children) kill(child, SIGTERM);
  for (const pid_t child : children) {
    for (int step = 0; !exitOfChild(child); ++step) {
      if (step == kPatienceSteps) kill(child, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

}  // namespace lodeline
