#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

/// Runs external programs in tests, to check that they can read the exported files.
namespace lodeline::test {

struct OutsideRun {
  int exit_code = -1;  ///< -1 where a signal ended it
  std::string output;  ///< standard output and error
};

/// Runs a command of the shell in a folder.
inline OutsideRun runIn(const std::filesystem::path& folder, const std::string& command) {
  OutsideRun run;
  FILE* pipe = popen(("cd '" + folder.string() + "' && { " + command + " ; } 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr)
    run.output += buffer.data();
  const int status = pclose(pipe);
  if (WIFEXITED(status)) run.exit_code = WEXITSTATUS(status);
  return run;
}

inline bool isInstalled(const std::string& program) {
  return runIn("/", "command -v " + program).exit_code == 0;
}

}  // namespace lodeline::test

/// Skips the test where a program is missing, naming its Debian package.
#define LODELINE_NEEDS_PROGRAM(program, package) \
  if (!lodeline::test::isInstalled(program))     \
  GTEST_SKIP() << program << " not found: apt-get install " << package
