#include "apps/lodeline/walls/walls_command.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/walls/make_run_walls.h"

namespace lodeline {
namespace {

void addSurfaceOptions(WallsArguments* arguments, CLI::App* command) {
  command->add_flag("--one-camera", arguments->one_camera,
                    "take depths from neighbouring images of the first camera, although the rig has two");
  command->add_option("--voxel", arguments->walls.fusion.voxel_m, "edge of the cells of the surface, m")
      ->check(CLI::Range(0.005, 0.5))
      ->capture_default_str();
  command
      ->add_option("--step", arguments->walls.depths.steps.step_m,
                   "distance between two keyframes with depths, m")
      ->check(CLI::Range(0.02, 5.0))
      ->capture_default_str();
  command
      ->add_option("--max-error", arguments->walls.depths.depth.max_sigma_m,
                   "largest expected error of a depth, m; farther walls are left out")
      ->check(CLI::Range(0.005, 0.25))
      ->capture_default_str();
  command
      ->add_option("--min-views", arguments->walls.fusion.min_views,
                   "number of keyframes that must see a place; others count as particles in the water")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command
      ->add_option("--spacing", arguments->map.stations.spacing_m,
                   "distance between cross-sections on a straight way, m")
      ->check(CLI::Range(0.5, 1000.0))
      ->capture_default_str();
}

void addWallsPlaceOptions(WallsArguments* arguments, CLI::App* command) {
  command->add_option(
      "--entrance", arguments->entrance,
      "place of the water's surface above the first pose, as in `export`; LAS and DXF are then on a grid");
  command->add_option("--crs", arguments->map.crs, "grid, as in `export`")->capture_default_str();
  command->add_option(
      "--turn", arguments->map.turn_deg,
      "clockwise turn of the run's world to true north, degrees, in place of the declination");
}

}  // namespace

void addWallsCommand(CLI::App& program) {
  const auto arguments = std::make_shared<WallsArguments>();
  CLI::App* command = program.add_subcommand(
      "walls", "Dense walls of a run: cloud, mesh, cross-sections, passage sizes and volume");
  command->add_option("RUN", arguments->run, "folder that `lodeline refine` or `lodeline run` wrote")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the files; without it, RUN/walls");
  command->add_option("--recording", arguments->recording, "recording of the run, where it has moved");
  addBagOptions(&arguments->bag, command);
  addSurfaceOptions(arguments.get(), command);
  addWallsPlaceOptions(arguments.get(), command);
  addRecordingPart(&arguments->part, command);
  addOverwrite(&arguments->overwrite, command);
  command->add_flag("--keep-work", arguments->keep_work, "keep depths and tiles in OUTPUT/work");
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "An interrupted command goes on when it is given again. --from and --to count from the first pose.\n"
      "Examples:\n"
      "  lodeline walls result -o walls\n"
      "  lodeline walls result -o walls --voxel 0.03 --spacing 2\n"
      "  lodeline walls result -o chamber --from 600 --to 720\n"
      "  lodeline walls result -o walls --recording /data/dive1 --entrance 29.83,-82.60,10");
  command->callback([arguments] { makeRunWalls(*arguments); });
}

}  // namespace lodeline
