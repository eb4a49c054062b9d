#pragma once

#include <map>
#include <string>
#include <vector>

namespace lodeline {

/// How much a finding may spoil the result, most harmful last.
enum class Severity { Notice, Warning, Serious };

/// One kind of finding, however often it occurred.
struct Finding {
  Severity severity = Severity::Notice;
  std::string kind;           ///< stable identifier, e.g. "imu_gap"
  std::string first_message;  ///< the message of the first occurrence
  int count = 0;
};

/// Collects what went wrong without stopping the work, folded by kind so that ten thousand equal warnings
/// make one line. Layers report into it; the command line ranks and prints it, and run.json keeps it.
class Diagnostics {
 public:
  /// Adds one occurrence. The first message of a kind is kept; the highest severity wins.
  void report(Severity severity, const std::string& kind, const std::string& message);

  /// Most severe first, then most frequent, then by name.
  std::vector<Finding> ranked() const;

  int count(const std::string& kind) const;

 private:
  std::map<std::string, Finding> findings_;
};

const char* toString(Severity severity);

}  // namespace lodeline
