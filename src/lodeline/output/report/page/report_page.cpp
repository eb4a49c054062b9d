#include "lodeline/output/report/page/report_page.h"

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/output/report/page/run_page.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

constexpr std::string_view kPlaceholder = "LODELINE_DATA";

/// JSON text that cannot end the script element around it.
std::string forScript(const nlohmann::ordered_json& data) {
  // Paths and messages may contain bytes that are not UTF-8.
  const std::string json = jsonText(data, -1);
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

std::string fillPage(const nlohmann::ordered_json& data) {
  const std::string_view page = pageTemplate();
  const size_t place = page.find(kPlaceholder);
  if (place == std::string_view::npos) {
    throw UsageError(
        "this program was built without the report page; install npm and configure the build again");
  }
  std::string text(page.substr(0, place));
  text += forScript(data);
  text += page.substr(place + kPlaceholder.size());
  return text;
}

std::string reportPage(const std::vector<std::filesystem::path>& runs, const ReportOptions& options,
                       Diagnostics* diagnostics) {
  nlohmann::ordered_json data = {{"live", false}, {"runs", nlohmann::ordered_json::array()}};
  ReportOptions of_run = options;
  for (const auto& run : runs) {
    of_run.progress = [&](double share) {
      options.progress((static_cast<double>(data["runs"].size()) + share) / static_cast<double>(runs.size()));
    };
    data["runs"].push_back(runPageJson(run, of_run, diagnostics, runs.size()));
  }
  options.progress(1.0);
  data["background"] = options.background;
  return fillPage(data);
}

}  // namespace lodeline
