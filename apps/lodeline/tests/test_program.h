#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

/// The program as a script sees it: exit codes, what it prints, what it writes.
namespace lodeline::test {

struct Execution {
  int exit_code = -1;  ///< -1 where a signal ended it
  std::string output;  ///< standard output and error
};

/// `lodeline`, as it was built.
std::filesystem::path programPath();

/// Runs `lodeline` with arguments in the shell's spelling.
Execution runProgram(const std::string& arguments);

/// A path for the shell.
std::string quoted(const std::filesystem::path& path);

std::string readText(const std::filesystem::path& file);
nlohmann::json readJson(const std::filesystem::path& file);

/// Figures of `lodeline evaluate ESTIMATE REFERENCE OPTIONS` as its --json gives them, which is written
/// beside the estimate. Throws std::runtime_error with the program's output where it fails.
nlohmann::json evaluateRun(const std::filesystem::path& estimate, const std::filesystem::path& reference,
                           const std::string& options);

}  // namespace lodeline::test
