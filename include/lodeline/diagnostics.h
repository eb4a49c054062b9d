#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace lodeline {

/// Error for input that cannot be used: a file is missing, damaged or contradicts another file. The message
/// names the file, the line or time stamp, the value found and the remedy. The program ends with exit code 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Error for a wrong command line or configuration. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Error for readable input from which no trajectory could be estimated. Exit code 3.
class EstimationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// How much a finding can degrade the result, in increasing order.
enum class Severity { Notice, Warning, Serious };

/// One kind of finding, however often it occurred.
struct Finding {
  Severity severity = Severity::Notice;
  std::string kind;           ///< stable identifier, e.g. "imu_gap"
  std::string first_message;  ///< the message of the first occurrence
  int count = 0;
};

/// Collects findings without stopping the program and groups them by kind, so that ten thousand equal
/// warnings make one line. Every layer reports into it. The command line ranks and prints the findings, and
/// run.json stores them.
class Diagnostics {
 public:
  /// Adds one occurrence. Keeps the first message of a kind and the highest severity.
  void report(Severity severity, const std::string& kind, const std::string& message);

  /// Findings sorted by severity (most severe first), then by count (most frequent first), then by name.
  std::vector<Finding> ranked() const;

  int count(const std::string& kind) const;

 private:
  std::map<std::string, Finding> findings_;
};

const char* toString(Severity severity);

}  // namespace lodeline
