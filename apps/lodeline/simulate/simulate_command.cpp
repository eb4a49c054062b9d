#include "apps/lodeline/simulate/simulate_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/interruption.h"
#include "apps/lodeline/simulate/simulate_recording.h"
#include "lodeline/cameras/camera_model.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

struct SimulateArguments {
  std::string scenario;
  std::string output;
  ScenarioChanges changes;
  int threads = 0;
  Verbosity verbosity;
  bool list_effects = false, overwrite = false;
};

/// Removes an earlier recording of the simulator, and nothing else, from the folder to write to.
void removeRecording(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "truth" / "scenario.yaml")) return;
  for (const char* part : {"mav0", "board.yaml", "truth"}) std::filesystem::remove_all(folder / part);
}

std::string footer() {
  std::string text = "Scenarios:\n";
  for (const Scenario& s : scenarios()) text += fmt::format("  {:<16}{}\n", s.name, s.description);
  text +=
      "\nExamples:\n"
      "  lodeline simulate demo -o demo --realism field\n"
      "  lodeline simulate cave1_short -o dive --metres 60 --effect flat_port=on\n"
      "  lodeline simulate demo -o fisheye --camera-model double-sphere\n"
      "  lodeline simulate figure_eight -o calibration --seed 7\n"
      "  lodeline simulate auv -o transects --metres 60\n"
      "  lodeline simulate current_ramps -o ramps --seed 7\n"
      "  lodeline simulate loop_cave -o second --cave-seed 1 --dive-seed 2 --tags 6\n\n"
      "An interrupted simulation goes on where it stopped when the same command is given again.";
  return text;
}

void printEffects() {
  fmt::print("{:<26}{:<7}{:<7}{:<10}{}\n", "effect", "clean", "field", "physical", "what it does");
  for (const EffectDescription& d : effectDescriptions()) {
    fmt::print("{:<26}{:<7}{:<7}{:<10}{}\n", d.name, d.in_clean ? "on" : "off", d.in_field ? "on" : "off",
               d.in_physical ? "on" : "off", d.what);
  }
}

void simulate(const SimulateArguments& arguments) {
  if (arguments.list_effects) return printEffects();
  if (arguments.scenario.empty()) throw UsageError("name a scenario; `lodeline simulate --help` lists them");
  if (arguments.output.empty()) throw UsageError("name the folder to write to with -o");
  const Scenario scenario = makeScenario(arguments.scenario, arguments.changes);
  if (arguments.overwrite) removeRecording(arguments.output);
  const RecordingSummary summary = simulateRecording(
      scenario, arguments.output, {.threads = arguments.threads, .quiet = arguments.verbosity.quiet});
  if (!summary.complete) {
    throw Interruption(fmt::format("{} of {} images are in {}; the same command goes on from there",
                                   summary.images.done, summary.images.total, arguments.output));
  }
  if (arguments.verbosity.quiet) return;
  fmt::print("{}: {:.1f} s, {:.1f} m, {} images in {}\n", scenario.name, summary.duration_s,
             summary.path_length_m, summary.images.total, arguments.output);
}

}  // namespace

void addScenarioOptions(CLI::App* command, ScenarioChanges* changes) {
  ScenarioChanges& c = *changes;
  command->add_option("--seconds", c.seconds,
                      "duration of the dive; without --metres, the length of the path follows");
  command->add_option("--metres", c.metres, "length of the path, m; without --seconds, the duration follows");
  command->add_option("--seed", c.seed, "seed of everything random (default: 1)");
  command->add_option("--cave-seed", c.cave_seed,
                      "seed of the cave: place, walls and tags (default: --seed)");
  command->add_option("--dive-seed", c.dive_seed,
                      "seed of the dive: motion, rig, lamps, water and disturbances (default: --seed)");
  command->add_option("--cave-metres", c.cave_metres, "length of the passage, m (default: half of the path)");
  command->add_option("--entrance", c.entrance, "2: begin at the far end of the passage (default: 1)");
  command->add_option("--laps", c.laps,
                      "number of rounds of a circuit or chamber (default: 2), or of a wreck (default: 3)");
  command->add_option("--tags", c.tags, "number of AprilTags on the line of the cave (default: 0)");
  command->add_option("--realism", c.realism,
                      "clean: exact files, clear water; field: errors of a real dive; physical: more optics, "
                      "water and life (default: clean)");
  command->add_option("--effect", c.effects, "effect to switch, as NAME=on or NAME=off; may be repeated");
  command->add_option("--width", c.width_px,
                      "width of the images, px; without --height, the height is 3/4 of it (default: 640)");
  command->add_option("--height", c.height_px, "height of the images, px");
  command->add_option("--camera-rate-hz", c.camera_rate_hz, "images per second (default: 15)");
  command->add_option("--imu-rate-hz", c.imu_rate_hz, "inertial readings per second (default: 200)");
  command->add_option("--magnetometer-rate-hz", c.magnetometer_rate_hz,
                      "magnetometer readings per second (default: 50)");
  command->add_option("--camera-model", c.camera_model,
                      "lens of the cameras: " + cameraModelNames() + " (default: that of the rig)");
  command->add_option("--readout-ms", c.readout_ms,
                      "readout time of a rolling shutter, which this switches on (default: drawn, 10 to 30)");
  command->add_option("--imu", c.imu_grade, "grade of the IMU: gx5-25, gv7 or consumer");
  command->add_flag("--starts-moving", c.starts_moving, "begin in mid-swim, not at rest");
}

void addSimulateCommand(CLI::App& program) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command =
      program.add_subcommand("simulate", "Make a recording of a simulated dive with exact truth");
  ScenarioChanges& c = arguments->changes;
  command->add_option("SCENARIO", arguments->scenario, "scenario, see below");
  command->add_option("-o,--output", arguments->output, "folder to write: mav0 (EuRoC layout) and truth");
  addScenarioOptions(command, &c);
  command->add_option("--cameras", c.cameras, "number of cameras, 1 or 2");
  command->add_flag("--sonar-ahead", c.sonar_ahead,
                    "scan a sector of the view with the sonar, not the plane across it");
  command->add_flag(
      "--cables-moved", c.cables_moved,
      "move the cables of a vehicle; its currents then disturb the magnetometer in another way");
  command->add_flag("--no-images", c.no_images, "write everything but the images");
  command->add_option("--threads", arguments->threads,
                      "number of threads for rendering (default: all cores)");
  addOverwrite(&arguments->overwrite, command);
  addVerbosity(&arguments->verbosity, command);
  command->add_flag("--list-effects", arguments->list_effects, "print all effects and end");
  command->footer(footer());
  command->callback([arguments] { simulate(*arguments); });
}

}  // namespace lodeline
