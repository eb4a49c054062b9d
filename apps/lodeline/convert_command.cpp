#include "apps/lodeline/convert_command.h"

#include <fmt/core.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/file_kind.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

struct ConvertArguments {
  std::string source;
  std::string target;
  BagArguments bag;
  std::string compression;
  std::string format;
  RecordingPart part;
  std::vector<int> cameras;
  bool overwrite = false;
  Verbosity verbosity;
};

/// Format of the bag to write; nothing for a folder in the EuRoC layout.
std::optional<BagFormat> targetFormat(const ConvertArguments& arguments) {
  const std::string extension = std::filesystem::path(arguments.target).extension().string();
  const bool is_named = arguments.format.empty();
  if (is_named ? extension == ".bag" : arguments.format == "ros1") return BagFormat::Ros1;
  if (is_named ? extension == ".mcap" : arguments.format == "mcap") return BagFormat::Mcap;
  if (is_named ? extension == ".db3" : arguments.format == "db3") return BagFormat::Database;
  return std::nullopt;
}

/// Removes the recording that an earlier conversion wrote to `target`: a bag with its rig file, or the files
/// of a recording in a folder. Other files stay, and the conversion then refuses the folder.
void removeTarget(const std::filesystem::path& source, const std::filesystem::path& target) {
  namespace fs = std::filesystem;
  if (!fs::exists(target)) return;
  // Removing a folder around the recording, such as dive for dive/mav0, would remove the recording.
  for (fs::path within = fs::weakly_canonical(source); within.has_relative_path();
       within = within.parent_path()) {
    if (fs::exists(within) && fs::equivalent(within, target))
      throw UsageError(target.string() + ": is or holds the recording to convert; name another DST");
  }
  if (!fs::is_directory(target)) {
    if (!isBag(target)) throw UsageError(target.string() + ": is no recording; --overwrite keeps it");
    fs::remove(rigFileBeside(target));
    fs::remove(target);
    return;
  }
  fs::remove_all(target / "mav0");
  for (const fs::directory_entry& entry : fs::directory_iterator(target)) {
    const std::string extension = entry.path().extension().string();
    const bool is_of_bag =
        extension == ".mcap" || extension == ".db3" || entry.path().filename() == "metadata.yaml";
    if (is_of_bag) fs::remove(entry.path());
  }
  if (fs::is_empty(target)) fs::remove(target);
}

ConvertSummary convertEitherWay(const ConvertArguments& arguments, Diagnostics* diagnostics) {
  Progress progress("conversion", arguments.verbosity.quiet);
  ConvertOptions options;
  options.progress = progress.function();
  options.rig_files.assign(arguments.bag.rig_files.begin(), arguments.bag.rig_files.end());
  options.topics = topicsOf(arguments.bag);
  options.compression = arguments.compression;
  options.cameras = arguments.cameras;
  options.part = {arguments.part.from_s, arguments.part.length_s()};
  const RecognizedFile source = recognizeFile(arguments.source);
  const bool from_bag = isBag(arguments.source);
  const bool from_video = !from_bag && isVideo(arguments.source);
  const bool is_other = !from_bag && !from_video && !source.isFolder();
  if (is_other) refuseFile(source, "convert takes a ROS bag, a film with telemetry or a folder with mav0");
  const std::optional<BagFormat> format = targetFormat(arguments);
  options.format = format.value_or(BagFormat::Ros1);
  if (from_video) {
    refuseBagOptions(arguments.source, arguments.bag);
    EurocOptions everything;
    everything.needs_calibration = false;
    everything.camera_indices = arguments.cameras;
    const std::unique_ptr<VideoSource> film =
        openVideo(arguments.source, everything, arguments.bag, diagnostics);
    return format ? convertToBag(film.get(), film->rigFile(), arguments.target, options, diagnostics)
                  : convertToFolder(film.get(), film->rigFile(), arguments.target, options, diagnostics);
  }
  if (from_bag) {
    return format ? convertBagToBag(arguments.source, arguments.target, options, diagnostics)
                  : convertBagToFolder(arguments.source, arguments.target, options, diagnostics);
  }
  if (!options.topics.empty()) throw UsageError("--topic is for reading a bag; here a folder is read");
  return format ? convertFolderToBag(arguments.source, arguments.target, options, diagnostics)
                : convertFolderToFolder(arguments.source, arguments.target, options, diagnostics);
}

/// Reports a part that has readings and no image: images may begin later than the other readings.
void reportPartWithoutImages(const RecordingPart& part, const ConvertSummary& summary,
                             Diagnostics* diagnostics) {
  const auto is_image = [](const auto& of_sensor) {
    return of_sensor.first.starts_with("cam") && of_sensor.second > 0;
  };
  if (part.isAll() || std::any_of(summary.readings.begin(), summary.readings.end(), is_image)) return;
  diagnostics->report(Severity::Warning, "part_without_images",
                      "the part of the recording has no image; times count from its first reading");
}

void convert(const ConvertArguments& arguments) {
  Diagnostics diagnostics;
  if (arguments.overwrite) removeTarget(arguments.source, arguments.target);
  const ConvertSummary summary = convertEitherWay(arguments, &diagnostics);
  if (summary.readings.empty()) {
    throw InputError(
        fmt::format("{}: nothing in it could be converted\n{}", arguments.source, findingsText(diagnostics)));
  }
  reportPartWithoutImages(arguments.part, summary, &diagnostics);
  if (!arguments.verbosity.quiet) {
    fmt::print("{}\n", arguments.target);
    for (const auto& [sensor, count] : summary.readings) fmt::print("  {:<12}{:>9}\n", sensor, count);
    if (!summary.rig_file.empty()) fmt::print("calibration: {}\n", summary.rig_file.string());
  }
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace

void addConvertCommand(CLI::App& program) {
  const auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = program.add_subcommand(
      "convert", "Turn a recording into another format: EuRoC folder, ROS 1 bag, ROS 2 bag (MCAP, SQLite)");
  command
      ->add_option("SRC", arguments->source,
                   "EuRoC folder (mav0), ROS bag (.bag, .mcap, .db3, folder) or film")
      ->required();
  command
      ->add_option("DST", arguments->target, "NAME.bag, NAME.mcap, NAME.db3, or a folder; must not exist yet")
      ->required();
  addBagOptions(&arguments->bag, command);
  command
      ->add_option("--format", arguments->format,
                   "format of DST where its name does not tell: folder (EuRoC), ros1, mcap, db3; mcap and "
                   "db3 make a folder with metadata.yaml for `ros2 bag`")
      ->check(CLI::IsMember({"folder", "ros1", "mcap", "db3"}));
  command
      ->add_option("--compression", arguments->compression,
                   "compression of the chunks of a bag: none (default of ROS 1), lz4, bz2 (ROS 1), zstd "
                   "(default of MCAP)")
      ->check(CLI::IsMember({"none", "lz4", "bz2", "zstd"}));
  addRecordingPart(&arguments->part, command);
  addCameras(&arguments->cameras, command);
  addOverwrite(&arguments->overwrite, command);
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "The calibration of a folder goes into NAME.rig.yaml beside the bag. --from and --to count from the "
      "first reading.\n"
      "Examples:\n"
      "  lodeline convert dive1 dive1.bag\n"
      "  lodeline convert dive1 dive1.mcap\n"
      "  lodeline convert dive1.bag excerpt.bag --from 120 --to 180\n"
      "  lodeline convert dive1 excerpt --from 120 --to 180 --cameras 0\n"
      "  lodeline convert dive1.bag dive1_ros2 --format db3\n"
      "  lodeline convert GX010042.MP4 dive1 --rig rig.yaml\n"
      "  lodeline convert dive1.bag dive1 --rig camchain-imucam.yaml --rig imu.yaml\n"
      "  lodeline convert dive1.bag dive1 --topic cam0=/left/image_raw --topic cam1=/right/image_raw");
  command->callback([arguments] { convert(*arguments); });
}

}  // namespace lodeline
