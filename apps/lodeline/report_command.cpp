#include "apps/lodeline/report_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/output/report/page/report_page.h"
#include "lodeline/pipeline/run_stations.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<fs::path> runs;
  std::string reference;
  std::string align = "se3";
  std::string output = "report.html";
};

void reportCommand(const Arguments& arguments) {
  Diagnostics diagnostics;
  ReportOptions options;
  options.stations = runStationsJson;
  if (!arguments.reference.empty()) {
    options.reference = {arguments.reference, alignmentTypeFromString(arguments.align)};
  }
  const std::string page = reportPage(arguments.runs, options, &diagnostics);
  writeOutput(arguments.output, page);
  fmt::print("{}: {:.1f} MB, {} run{}\n{}", arguments.output, 1e-6 * static_cast<double>(page.size()),
             arguments.runs.size(), arguments.runs.size() > 1 ? "s" : "", findingsText(diagnostics));
}

}  // namespace

void addReportCommand(CLI::App& program) {
  CLI::App* command = program.add_subcommand("report", "Show runs in one page for the browser");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("RUN", arguments->runs, "output folders of `lodeline run`; several are compared")
      ->required();
  command->add_option("--reference", arguments->reference,
                      "trajectory taken as true, in any layout that `lodeline evaluate` reads");
  command->add_option("--align", arguments->align, "none, yaw, se3 or sim3")->capture_default_str();
  command->add_option("-o,--output", arguments->output, "file to write")->capture_default_str();
  command->footer(
      "Examples:\n"
      "  lodeline report dive1_result -o dive1.html\n"
      "  lodeline report with_mag without_mag --reference dive1/truth.tum --align none -o comparison.html\n"
      "The page is one file that works without a network; docs/how-to/report.md tells what it shows.");
  command->callback([arguments] { reportCommand(*arguments); });
}

}  // namespace lodeline
