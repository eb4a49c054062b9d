#include "lodeline/pipeline/run_outcome.h"

#include <fmt/core.h>

#include "lodeline/inspection/start_check.h"

namespace lodeline {
namespace {

[[noreturn]] void distrust(const RunRequest& request, const std::string& reason, const std::string& advice) {
  const std::string where = request.output.empty() ? "" : " in " + request.output;
  throw EstimationError(fmt::format("{}: {}; the result{} is not to be trusted. `lodeline inspect {}` {}",
                                    request.data, reason, where, request.data, advice));
}

}  // namespace

void requireResult(const RunRequest& request, const RunSummary& summary, const Diagnostics& diagnostics) {
  if (const std::string reason = summary.distrust(); !reason.empty()) {
    distrust(request, reason,
             "looks for units, axes, time stamps and calibrations that do not belong together");
  }
  if (summary.posed() > 0) {
    if (diagnostics.count(kSensorsContradict) == 0) return;
    distrust(request, "the sensors contradict each other", "says what is wrong");
  }
  const std::vector<Finding> findings = diagnostics.ranked();
  if (summary.images == 0) {
    throw InputError(fmt::format("{}: no image of the recording could be used{}", request.data,
                                 findings.empty() ? "" : ": " + findings.front().first_message));
  }
  const bool is_explained = !findings.empty() && findings.front().severity == Severity::Serious;
  throw EstimationError(fmt::format("{}: no pose after {} frames; still waiting for {}{}", request.data,
                                    summary.frames(), summary.last().waiting_for,
                                    is_explained ? ". " + findings.front().first_message : ""));
}

}  // namespace lodeline
