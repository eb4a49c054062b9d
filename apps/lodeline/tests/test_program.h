#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

/// Runs the program like a script: exit codes, printed output, written files.
namespace lodeline::test {

struct Execution {
  int exit_code = -1;  ///< -1 where a signal ended it
  std::string output;  ///< standard output and error
};

/// Path of the built `lodeline`.
std::filesystem::path programPath();

/// Runs `lodeline` with arguments in shell syntax.
Execution runProgram(const std::string& arguments);

/// A path quoted for the shell.
std::string quoted(const std::filesystem::path& path);

std::string readText(const std::filesystem::path& file);
nlohmann::json readJson(const std::filesystem::path& file);

/// Results of `lodeline evaluate ESTIMATE REFERENCE OPTIONS` from its --json file, which is written beside
/// the estimate. Throws std::runtime_error with the program's output where it fails.
nlohmann::json evaluateRun(const std::filesystem::path& estimate, const std::filesystem::path& reference,
                           const std::string& options);

}  // namespace lodeline::test
