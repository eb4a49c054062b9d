#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lodeline {

/// What a child process is started with.
struct ChildCommand {
  std::vector<std::string> words;  ///< after the name of this program
  std::filesystem::path folder;    ///< in which it runs
  std::filesystem::path output;    ///< file for its standard output, which is replaced
  std::filesystem::path errors;    ///< file for its standard error, which is replaced
};

/// Starts this program as a child process in a new process group. The system kills it when this process dies.
/// Throws std::runtime_error where no process can be made.
pid_t startChild(const ChildCommand& command);

/// Exit code of a child that has ended, 128 + N for one ended by signal N. Empty while it runs.
std::optional<int> exitOfChild(pid_t child);

/// Ends children by SIGTERM, and by SIGKILL after a few seconds. Returns when all have ended.
void endChildren(const std::vector<pid_t>& children);

}  // namespace lodeline
