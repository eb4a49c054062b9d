#include "lodeline/diagnostics.h"

#include <algorithm>
#include <tuple>

#include "lodeline/util/printable_text.h"

namespace lodeline {

void Diagnostics::report(Severity severity, const std::string& kind, const std::string& message) {
  Finding& finding = findings_[kind];
  if (finding.count == 0) {
    finding.kind = kind;
    finding.first_message = printableText(message);
    finding.severity = severity;
  }
  finding.severity = std::max(finding.severity, severity);
  ++finding.count;
}

std::vector<Finding> Diagnostics::ranked() const {
  std::vector<Finding> ranked;
  for (const auto& [kind, finding] : findings_) ranked.push_back(finding);
  std::sort(ranked.begin(), ranked.end(), [](const Finding& a, const Finding& b) {
    return std::make_tuple(b.severity, b.count, a.kind) < std::make_tuple(a.severity, a.count, b.kind);
  });
  return ranked;
}

int Diagnostics::count(const std::string& kind) const {
  const auto found = findings_.find(kind);
  return found == findings_.end() ? 0 : found->second.count;
}

const char* toString(Severity severity) {
  switch (severity) {
    case Severity::Notice:
      return "notice";
    case Severity::Warning:
      return "warning";
    case Severity::Serious:
      return "serious";
  }
  return "unknown";
}

}  // namespace lodeline
