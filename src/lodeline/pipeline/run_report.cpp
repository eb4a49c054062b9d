#include "lodeline/pipeline/run_report.h"

#include <fmt/core.h>

#include <filesystem>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/output/report/page/report_page.h"
#include "lodeline/pipeline/page/run_stations.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {

namespace fs = std::filesystem;

std::string writeRunReport(const RunRequest& request) {
  if (pageTemplate().empty()) {
    return "report.html left out: this program was built without npm, which bundles the page";
  }
  const fs::path folder = request.output;
  const std::optional<fs::path> truth = referenceOfRecording(request.data);
  Diagnostics ignored;  // files just written are whole
  ReportOptions options;
  options.stations = runStationsJson;
  if (truth) options.reference = {*truth, AlignmentType::SE3};
  std::string page;
  std::string remark;
  try {
    page = reportPage({folder}, options, &ignored);
  } catch (const InputError& error) {
    if (!options.reference) throw;
    remark = fmt::format("without the recording's ground truth: {}", error.what());
    options.reference.reset();
    page = reportPage({folder}, options, &ignored);
  }
  writeOutput(folder / "report.html", page);
  return remark;
}

}  // namespace lodeline
