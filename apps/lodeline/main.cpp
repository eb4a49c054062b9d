#include <fmt/core.h>
#include <glog/logging.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/lodeline/allan_command.h"
#include "apps/lodeline/attitude_command.h"
#include "apps/lodeline/batch/batch_command.h"
#include "apps/lodeline/benchmark/benchmark_command.h"
#include "apps/lodeline/calibrate_command.h"
#include "apps/lodeline/calibration_file_commands.h"
#include "apps/lodeline/compare/compare_command.h"
#include "apps/lodeline/convert_command.h"
#include "apps/lodeline/evaluate_command.h"
#include "apps/lodeline/export/export_command.h"
#include "apps/lodeline/inspect_command.h"
#include "apps/lodeline/map/map_command.h"
#include "apps/lodeline/program/help_formatter.h"
#include "apps/lodeline/program/help_groups.h"
#include "apps/lodeline/program/manual_command.h"
#include "apps/lodeline/program/settings_command.h"
#include "apps/lodeline/program/shell_completion.h"
#include "apps/lodeline/refine_command.h"
#include "apps/lodeline/report_command.h"
#include "apps/lodeline/run_command.h"
#include "apps/lodeline/shared/arguments.h"
#include "apps/lodeline/shared/build_info.h"
#include "apps/lodeline/shared/interruption.h"
#include "apps/lodeline/simulate/simulate_command.h"
#include "apps/lodeline/survey/survey_command.h"
#include "apps/lodeline/walls/walls_command.h"
#include "lodeline/diagnostics.h"
#include "lodeline/util/printable_text.h"
#include "lodeline/version.h"

namespace {

// Exit codes for scripts: each identifies the reason why the program ended.
enum ExitCode { kGood = 0, kBadInput = 1, kBadUsage = 2, kEstimationFailed = 3, kInterrupted = 130 };

int fail(const char* kind, const std::exception& error, ExitCode code) {
  fmt::print(stderr, "{}: {}\n", kind, lodeline::printableText(error.what()));
  return code;
}

/// Limits the log of Ceres (glog) to errors. Its warnings are about steps from which it recovers;
/// everything relevant to the user is in the run's findings.
void quietSolverLog(const char* program) {
  FLAGS_logtostderr = true;
  FLAGS_minloglevel = google::GLOG_ERROR;
  google::InitGoogleLogging(program);
}

}  // namespace

int main(int argc, char** argv) {
  quietSolverLog(argv[0]);
  CLI::App program("Lodeline: where a camera rig went and which way it faced, from images and inertial data");
  program.name("lodeline");
  const lodeline::BuildInfo build = lodeline::buildInfo();
  program.set_version_flag(
      "--version", fmt::format("lodeline {} (commit {}, {})", LODELINE_VERSION, build.commit, build.type));
  program.formatter(std::make_shared<lodeline::HelpFormatter>());
  program.require_subcommand(1);
  program.footer("`lodeline help COMMAND` explains a command, with examples.");
  lodeline::addRunCommand(program);
  lodeline::addRefineCommand(program);
  lodeline::addAttitudeCommand(program);
  lodeline::addBatchCommand(program);
  lodeline::addInspectCommand(program);
  lodeline::addConvertCommand(program);
  lodeline::addCalibrateCommand(program);
  lodeline::addAllanCommand(program);
  lodeline::addConvertCalibrationCommand(program);
  lodeline::addRigTemplateCommand(program);
  lodeline::addExportCommand(program);
  lodeline::addMapCommand(program);
  lodeline::addSurveyCommand(program);
  lodeline::addWallsCommand(program);
  lodeline::addReportCommand(program);
  lodeline::addEvaluateCommand(program);
  lodeline::addCompareCommand(program);
  lodeline::addBenchmarkCommand(program);
  lodeline::addSimulateCommand(program);
  lodeline::addSettingsCommand(program);
  lodeline::addCompletionCommand(program);
  lodeline::addManualCommand(program);
  lodeline::makeHelpGroups(program);
  try {
    std::vector<std::string> arguments = lodeline::withJoinedPlaces(
        lodeline::completeLiveOption(lodeline::withHelpAsOption({argv + 1, argv + argc})));
    lodeline::refuseUnknownWords(program, arguments);
    std::reverse(arguments.begin(), arguments.end());  // the order that CLI11 expects
    program.parse(std::move(arguments));
    return kGood;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kGood : kBadUsage;
  } catch (const lodeline::InputError& error) {
    return fail("bad input", error, kBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    // A path that cannot be resolved: circular links, missing permissions, too many open files.
    const auto reason = error.path1().string() + ": " + error.code().message();
    return fail("bad input", lodeline::InputError(reason), kBadInput);
  } catch (const lodeline::BatchError& error) {
    return fail("items failed", error, kBadInput);
  } catch (const lodeline::UsageError& error) {
    return fail("bad usage", error, kBadUsage);
  } catch (const lodeline::EstimationError& error) {
    return fail("estimation failed", error, kEstimationFailed);
  } catch (const lodeline::Interruption& error) {
    return fail("interrupted", error, kInterrupted);
  } catch (const std::exception& error) {
    return fail("unexpected failure", error, kEstimationFailed);
  }
}
