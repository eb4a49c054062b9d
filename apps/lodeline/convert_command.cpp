#include "apps/lodeline/convert_command.h"

#include <fmt/core.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

struct ConvertArguments {
  std::string source;
  std::string target;
  BagArguments bag;
  std::string compression = "none";
};

ConvertSummary convertEitherWay(const ConvertArguments& arguments, Diagnostics* diagnostics) {
  ConvertOptions options;
  options.rig_files.assign(arguments.bag.rig_files.begin(), arguments.bag.rig_files.end());
  options.topics = topicsOf(arguments.bag);
  options.compression = arguments.compression;
  const RecognizedFile source = recognizeFile(arguments.source);
  const bool from_bag = isBag(arguments.source);
  const bool is_other = !from_bag && !source.isFolder();
  if (is_other) refuseFile(source, "convert takes a bag (NAME.bag) and a folder, in either order");
  if (from_bag == isBag(arguments.target)) {
    throw UsageError("convert takes a bag (NAME.bag) and a folder, in either order");
  }
  if (from_bag) return convertBagToFolder(arguments.source, arguments.target, options, diagnostics);
  if (!options.topics.empty()) throw UsageError("--topic is for reading a bag; here one is written");
  return convertFolderToBag(arguments.source, arguments.target, options, diagnostics);
}

void convert(const ConvertArguments& arguments) {
  Diagnostics diagnostics;
  const ConvertSummary summary = convertEitherWay(arguments, &diagnostics);
  if (summary.readings.empty()) {
    throw InputError(
        fmt::format("{}: nothing in it could be converted\n{}", arguments.source, findingsText(diagnostics)));
  }
  fmt::print("{}\n", arguments.target);
  for (const auto& [sensor, count] : summary.readings) fmt::print("  {:<12}{:>9}\n", sensor, count);
  if (!summary.rig_file.empty()) fmt::print("calibration: {}\n", summary.rig_file.string());
  fmt::print("{}", findingsText(diagnostics));
}

}  // namespace

void addConvertCommand(CLI::App& program) {
  const auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command =
      program.add_subcommand("convert", "Turn a ROS 1 bag into an EuRoC folder, or a folder into a bag");
  command->add_option("SRC", arguments->source, "NAME.bag, or a folder with mav0 (EuRoC ASL layout)")
      ->required();
  command->add_option("DST", arguments->target, "the other one; must not be there yet")->required();
  addBagOptions(&arguments->bag, command);
  command->add_option("--compression", arguments->compression, "of the chunks of a bag that is written")
      ->check(CLI::IsMember({"none", "lz4", "bz2"}))
      ->capture_default_str();
  command->footer(
      "Readings, stamps and pixels are kept; what the other format cannot hold is told. The calibration of "
      "a\n"
      "folder goes into NAME.rig.yaml beside NAME.bag, and is found there again.\n"
      "Examples:\n"
      "  lodeline convert dive1 dive1.bag\n"
      "  lodeline convert dive1.bag dive1 --rig camchain-imucam.yaml --rig imu.yaml\n"
      "  lodeline convert dive1.bag dive1 --topic cam0=/left/image_raw --topic cam1=/right/image_raw");
  command->callback([arguments] { convert(*arguments); });
}

}  // namespace lodeline
