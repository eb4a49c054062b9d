#include "apps/lodeline/calibration_file_commands.h"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

/// To the file that -o names, or to standard output. Throws InputError for one that is there already and may
/// not be overwritten.
void writeText(const std::string& text, const std::string& output, bool overwrite) {
  if (output.empty()) {
    fmt::print("{}", text);
    return;
  }
  if (!overwrite && std::filesystem::exists(output)) {
    throw InputError(output + ": is there already; choose another name, or say --overwrite");
  }
  writeOutput(output, text);
}

void reportMissing(const RigFile& rig, Diagnostics* diagnostics) {
  const auto report = [&](const std::string& what) {
    diagnostics->report(Severity::Warning, "calibration_incomplete", what);
  };
  for (const std::string& camera : rig.without_extrinsics) {
    report(fmt::format(
        "no file says how {} is mounted: fill in its T_BS (camera to IMU), by Kalibr for example", camera));
  }
  if (!rig.has_imu)
    report("no file describes the IMU: add a section imu0 (`lodeline rig-template` shows one)");
  if (rig.rig.cameras.empty()) report("no file describes a camera");
}

void convertCalibration(const std::vector<std::string>& files, const std::string& output, bool overwrite,
                        const Verbosity& verbosity) {
  Diagnostics diagnostics;
  const RigSections sections = collectRigSections({files.begin(), files.end()}, &diagnostics);
  const RigFile rig = readRig(sections, {.needs_extrinsics = false}, &diagnostics);
  reportMissing(rig, &diagnostics);
  writeText(rigText(rig), output, overwrite);
  // Standard output may hold the rig file.
  if (!output.empty() && !verbosity.quiet) fmt::print("{}\n", output);
  printFindings(diagnostics, verbosity, stderr);
}

}  // namespace

void addConvertCalibrationCommand(CLI::App& program) {
  struct Arguments {
    std::vector<std::string> files;
    std::string output;
    bool overwrite = false;
    Verbosity verbosity;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      program.add_subcommand("convert-calibration", "Turn another program's calibration into a rig file");
  command->add_option("FILES", arguments->files, "calibrations that together describe a rig")->required();
  command->add_option("-o,--output", arguments->output, "the rig file; without it standard output")
      ->type_name("FILE");
  addOverwrite(&arguments->overwrite, command);
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "docs/how-to/read-calibrations.md lists the programs. `--rig` reads their files directly.\n"
      "Examples:\n"
      "  lodeline convert-calibration euroc_stereo_imu_config.yaml -o rig.yaml\n"
      "  lodeline convert-calibration kalibr_imucam_chain.yaml kalibr_imu_chain.yaml -o rig.yaml\n"
      "  lodeline convert-calibration left.yaml right.yaml extrinsics_and_imu.yaml -o rig.yaml");
  command->callback([arguments] {
    convertCalibration(arguments->files, arguments->output, arguments->overwrite, arguments->verbosity);
  });
}

void addRigTemplateCommand(CLI::App& program) {
  struct Arguments {
    std::string output;
    bool overwrite = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand("rig-template", "Print a rig file to fill in");
  command->add_option("-o,--output", arguments->output, "write it to this file")->type_name("FILE");
  addOverwrite(&arguments->overwrite, command);
  command->footer("Example:\n  lodeline rig-template -o rig.yaml");
  command->callback([arguments] { writeText(rigTemplate(), arguments->output, arguments->overwrite); });
}

}  // namespace lodeline
