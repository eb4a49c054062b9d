#pragma once

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace lodeline::test {

/// A child process that runs in parallel with the test and ends with it.
class ChildProcess {
 public:
  /// Starts a command found in PATH, with its output in the file `log`.
  ChildProcess(const std::vector<std::string>& command, const std::string& log) : pid_(fork()) {
    if (pid_ < 0) throw std::runtime_error("no further process can be made");
    if (pid_ > 0) return;
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    if (freopen(log.c_str(), "w", stdout) == nullptr) _exit(126);
    dup2(STDOUT_FILENO, STDERR_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  ~ChildProcess() {
    if (pid_ <= 0) return;
    interrupt();
    if (waitFor(10.0) == kRunning) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  static constexpr int kRunning = -1;
  static constexpr int kKilled = -2;

  pid_t id() const { return pid_; }

  /// Sends SIGINT, as Ctrl-C does.
  void interrupt() const { kill(pid_, SIGINT); }

  /// Exit code; kRunning where the process has not ended in time, kKilled where a signal ended it.
  int waitFor(double timeout_s) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    int state = 0;
    while (waitpid(pid_, &state, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) return kRunning;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    pid_ = 0;
    return WIFEXITED(state) ? WEXITSTATUS(state) : kKilled;
  }

 private:
  pid_t pid_;
};

/// A TCP port of this machine that was free at the time of the call.
inline int freePort() {
  const int socket_number = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  const bool bound = bind(socket_number, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
                     getsockname(socket_number, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  close(socket_number);
  if (!bound) throw std::runtime_error("no port is free");
  return ntohs(address.sin_port);
}

}  // namespace lodeline::test
