#include <fmt/core.h>
#include <glog/logging.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/base/error.h"
#include "lodeline/base/printable_text.h"
#include "lodeline/cli/allan_command.h"
#include "lodeline/cli/arguments.h"
#include "lodeline/cli/attitude_command.h"
#include "lodeline/cli/calibrate_command.h"
#include "lodeline/cli/calibration_file_commands.h"
#include "lodeline/cli/compare_command.h"
#include "lodeline/cli/convert_command.h"
#include "lodeline/cli/evaluate_command.h"
#include "lodeline/cli/export_command.h"
#include "lodeline/cli/inspect_command.h"
#include "lodeline/cli/interruption.h"
#include "lodeline/cli/refine_command.h"
#include "lodeline/cli/report_command.h"
#include "lodeline/cli/run_command.h"
#include "lodeline/cli/simulate_command.h"

namespace {

// The contract with scripts: what ended the program can be told from its exit code.
enum ExitCode { kGood = 0, kBadInput = 1, kBadUsage = 2, kEstimationFailed = 3, kInterrupted = 130 };

int fail(const char* kind, const std::exception& error, ExitCode code) {
  fmt::print(stderr, "{}: {}\n", kind, lodeline::printableText(error.what()));
  return code;
}

/// Ceres logs through glog. Its warnings tell of steps that it recovers from; what matters to the user is in
/// the run's findings.
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
  program.set_version_flag("--version", "lodeline " LODELINE_VERSION);
  program.require_subcommand(1);
  program.footer("`lodeline COMMAND --help` explains a command, with examples.");
  lodeline::addRunCommand(program);
  lodeline::addRefineCommand(program);
  lodeline::addEvaluateCommand(program);
  lodeline::addCompareCommand(program);
  lodeline::addExportCommand(program);
  lodeline::addReportCommand(program);
  lodeline::addSimulateCommand(program);
  lodeline::addAllanCommand(program);
  lodeline::addAttitudeCommand(program);
  lodeline::addCalibrateCommand(program);
  lodeline::addConvertCommand(program);
  lodeline::addConvertCalibrationCommand(program);
  lodeline::addRigTemplateCommand(program);
  lodeline::addInspectCommand(program);
  try {
    std::vector<std::string> arguments =
        lodeline::withJoinedPlaces(lodeline::completeLiveOption({argv + 1, argv + argc}));
    lodeline::refuseUnknownWords(program, arguments);
    std::reverse(arguments.begin(), arguments.end());  // which is how CLI11 takes them
    program.parse(std::move(arguments));
    return kGood;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kGood : kBadUsage;
  } catch (const lodeline::InputError& error) {
    return fail("bad input", error, kBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    // A path that cannot be followed: links in a circle, missing rights, too many open files.
    const auto reason = error.path1().string() + ": " + error.code().message();
    return fail("bad input", lodeline::InputError(reason), kBadInput);
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
