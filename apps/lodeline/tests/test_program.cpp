#include "apps/lodeline/tests/test_program.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace lodeline::test {

std::filesystem::path programPath() { return LODELINE_PROGRAM; }

Execution runProgram(const std::string& arguments) {
  Execution result;
  FILE* pipe = popen(fmt::format("{} {} 2>&1", quoted(programPath()), arguments).c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) {
    result.output += buffer.data();
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

std::string quoted(const std::filesystem::path& path) { return fmt::format("'{}'", path.string()); }

std::string readText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

nlohmann::json readJson(const std::filesystem::path& file) { return nlohmann::json::parse(readText(file)); }

nlohmann::json evaluateRun(const std::filesystem::path& estimate, const std::filesystem::path& reference,
                           const std::string& options) {
  const std::filesystem::path json = estimate.string() + "_evaluation.json";
  const Execution result = runProgram(
      fmt::format("evaluate {} {} {} --json {}", quoted(estimate), quoted(reference), options, quoted(json)));
  if (result.exit_code != 0) throw std::runtime_error(result.output);
  return readJson(json);
}

}  // namespace lodeline::test
