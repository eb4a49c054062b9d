#include "lodeline/output/report/findings.h"

#include <fmt/format.h>

namespace lodeline {

std::string findingsText(const Diagnostics& diagnostics) {
  std::string text;
  for (const Finding& finding : diagnostics.ranked()) {
    const std::string times = finding.count > 1 ? fmt::format(" ({} times)", finding.count) : "";
    text += fmt::format("{}: {}{}\n", toString(finding.severity), finding.first_message, times);
  }
  return text;
}

nlohmann::ordered_json findingsJson(const Diagnostics& diagnostics,
                                    const std::function<std::string(const std::string&)>& readable) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Finding& finding : diagnostics.ranked()) {
    json.push_back({{"severity", toString(finding.severity)},
                    {"kind", finding.kind},
                    {"message", readable ? readable(finding.first_message) : finding.first_message},
                    {"count", finding.count}});
  }
  return json;
}

}  // namespace lodeline
