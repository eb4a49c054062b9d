#include "apps/lodeline/report_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/print_page.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/output/report/page/report_page.h"
#include "lodeline/pipeline/page/background.h"
#include "lodeline/pipeline/page/run_stations.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<fs::path> runs;
  std::string reference;
  std::string align = "se3";
  std::string background;
  std::string background_at;
  std::string output = "report.html";
  std::string pdf;
  bool is_page_named = false;
  Verbosity verbosity;
};

nlohmann::ordered_json backgroundOf(const ReportArguments& arguments) {
  if (arguments.background.empty()) {
    if (arguments.background_at.empty()) return nullptr;
    throw UsageError("--background-at: --background names no file to be placed");
  }
  if (!arguments.reference.empty())
    throw UsageError(
        "--background and --reference: the page is in the world of the reference, whose place is not known");
  if (arguments.background_at.empty())
    throw UsageError("--background: --background-at tells where on it the first pose is");
  return readBackground(arguments.background, arguments.background_at);
}

void printDone(const std::string& file, size_t bytes, size_t runs, const Verbosity& verbosity) {
  if (verbosity.quiet) return;
  fmt::print("{}: {:.1f} MB, {} run{}\n", file, 1e-6 * static_cast<double>(bytes), runs, runs > 1 ? "s" : "");
}

void reportCommand(const ReportArguments& arguments) {
  Diagnostics diagnostics;
  ReportOptions options;
  options.stations = runStationsJson;
  if (!arguments.reference.empty()) {
    options.reference = {arguments.reference, alignmentTypeFromString(arguments.align)};
  }
  options.background = backgroundOf(arguments);
  Progress progress("page", arguments.verbosity.quiet);
  options.progress = progress.function();
  const std::string page = reportPage(arguments.runs, options, &diagnostics);
  progress.end();
  if (arguments.pdf.empty() || arguments.is_page_named) {
    writeOutput(arguments.output, page);
    printDone(arguments.output, page.size(), arguments.runs.size(), arguments.verbosity);
  }
  if (!arguments.pdf.empty()) {
    const char* path = std::getenv("PATH");
    progress.begin("printing by Chromium");
    printPage(page, arguments.pdf, path == nullptr ? "" : path);
    progress.end();
    printDone(arguments.pdf, fs::file_size(arguments.pdf), arguments.runs.size(), arguments.verbosity);
  }
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace

void addReportCommand(CLI::App& program) {
  CLI::App* command = program.add_subcommand("report", "Show runs in one page for the browser");
  const auto arguments = std::make_shared<ReportArguments>();
  command->add_option("RUN", arguments->runs, "output folders of `lodeline run`; several are compared")
      ->required();
  command->add_option("--reference", arguments->reference,
                      "ground truth, in any layout that `lodeline evaluate` reads");
  command->add_option("--align", arguments->align, "none, yaw, se3 or sim3")->capture_default_str();
  command
      ->add_option("--background", arguments->background,
                   "map below the plan: PNG or JPEG image with a world file, or GeoJSON lines")
      ->type_name("FILE");
  command
      ->add_option("--background-at", arguments->background_at,
                   "place of the first pose on the map: LAT,LON (GeoJSON in degrees) or E,N[,TURN] (m on its "
                   "grid; TURN: degrees from the north of the run clockwise to that of the map)")
      ->type_name("PLACE");
  CLI::Option* output = command
                            ->add_option("-o,--output", arguments->output,
                                         "file of the page; with --pdf, written only where named")
                            ->capture_default_str();
  command->add_option("--pdf", arguments->pdf, "print the page to this file (A4; needs Chromium)")
      ->type_name("FILE");
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "Examples:\n"
      "  lodeline report dive1_result -o dive1.html\n"
      "  lodeline report with_mag without_mag --reference dive1/truth.tum --align none -o comparison.html\n"
      "  lodeline report dive1_result --pdf dive1.pdf\n"
      "  lodeline report dive1_result --background plan.png --background-at 372410.5,3298801.2\n"
      "docs/how-to/report.md explains the page.");
  command->callback([arguments, output] {
    arguments->is_page_named = output->count() > 0;
    reportCommand(*arguments);
  });
}

}  // namespace lodeline
