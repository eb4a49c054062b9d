#include "apps/lodeline/inspect_command.h"

#include <fmt/core.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/inspection/inspection_report.h"
#include "lodeline/inspection/survey/excerpt_source.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/bag_listing.h"
#include "lodeline/io/video/video_text.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

struct InspectArguments {
  std::string data;
  BagArguments bag;
  std::string json;
  std::optional<size_t> list_elements;
  SiteArguments site;
  RecordingPart part;
  std::vector<int> cameras;
  Verbosity verbosity;
};

/// Prints every message of a bag.
void listBag(const InspectArguments& arguments) {
  if (!isBag(arguments.data)) throw UsageError("--messages is for ROS bags");
  Diagnostics diagnostics;
  const std::unique_ptr<BagFile> bag = openBagFile(arguments.data, &diagnostics);
  fmt::print("{}", topicsText(*bag));
  std::fflush(stdout);
  listMessages(bag.get(), *arguments.list_elements, &std::cout);
  std::cout.flush();
  printFindings(diagnostics, arguments.verbosity);
}

/// Opens a recording, even if no estimate is possible from it.
std::unique_ptr<MeasurementSource> openWhatThereIs(const InspectArguments& arguments,
                                                   Diagnostics* diagnostics) {
  EurocOptions options;
  options.needs_cameras = options.needs_imu = options.needs_calibration = false;
  options.camera_indices = arguments.cameras;
  std::unique_ptr<MeasurementSource> source =
      openRecording(arguments.data, options, arguments.bag, diagnostics);
  if (arguments.part.isAll()) return source;
  constexpr double kToTheEnd_s = 1e7;
  return std::make_unique<ExcerptSource>(std::move(source), arguments.part.from_s,
                                         arguments.part.length_s().value_or(kToTheEnd_s));
}

void inspectRecording(const InspectArguments& arguments) {
  if (arguments.list_elements) return listBag(arguments);
  cv::setNumThreads(1);
  InspectionOptions options;
  options.site_field_W = arguments.site.field_ENU();
  Progress progress("inspection", arguments.verbosity.quiet);
  options.progress = progress.function();
  const Inspection inspection =
      inspect([&](Diagnostics* diagnostics) { return openWhatThereIs(arguments, diagnostics); }, options);
  progress.end();
  if (!arguments.json.empty()) writeOutput(arguments.json, jsonText(inspectionJson(inspection)) + "\n");
  fmt::print("{}", inspectionText(inspection));
  if (isVideo(arguments.data)) {
    Diagnostics told_above;
    EurocOptions everything;
    everything.needs_calibration = false;
    fmt::print("{}", videoText(*openVideo(arguments.data, everything, arguments.bag, &told_above)));
  }
  if (!isBag(arguments.data)) return;
  Diagnostics reported_above;
  fmt::print("{}", topicsText(*openBagFile(arguments.data, &reported_above)));
}

}  // namespace

void addInspectCommand(CLI::App& program) {
  const auto arguments = std::make_shared<InspectArguments>();
  CLI::App* command =
      program.add_subcommand("inspect", "Tell what is wrong with a recording, the most harmful first");
  command
      ->add_option("DATA", arguments->data,
                   "EuRoC folder (mav0), ROS bag (.bag, .mcap, .db3, folder), film or sensor log (CSV, zip, "
                   "PX4, ArduPilot)")
      ->required();
  addBagOptions(&arguments->bag, command);
  command
      ->add_option("--messages", arguments->list_elements,
                   "print every message of a bag instead, with N elements of long arrays")
      ->type_name("N")
      ->expected(0, 1)
      ->default_str("16");
  command->add_option("--json", arguments->json, "write all figures to this file");
  addSite(&arguments->site, command);
  addRecordingPart(&arguments->part, command);
  addCameras(&arguments->cameras, command);
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "docs/reference/findings.md explains each finding.\n"
      "Examples:\n"
      "  lodeline inspect dive1\n"
      "  lodeline inspect dive1.mcap --messages\n"
      "  lodeline inspect dive1.bag --rig rig.yaml --json inspection.json --site 29.83,-82.60,0 --date "
      "2026-11-21");
  command->callback([arguments] { inspectRecording(*arguments); });
}

}  // namespace lodeline
