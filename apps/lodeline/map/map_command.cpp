#include "apps/lodeline/map/map_command.h"

#include "apps/lodeline/map/map_subcommands.h"

namespace lodeline {

void addMapCommand(CLI::App& program) {
  CLI::App* map = program.add_subcommand("map", "Many dives in one map");
  map->require_subcommand(1);
  addMapBuildCommands(map);
  addMapContentCommands(map);
  addMapControlCommand(map);
  addMapRelocaliseCommand(map);
  addMapExportCommand(map);
  map->footer(
      "Examples:\n"
      "  lodeline map build cave.db dive1_result dive2_result\n"
      "  lodeline map add cave.db dive3_result --start 120.5,-30.2,0\n"
      "  lodeline map control cave.db stations.csv\n"
      "  lodeline map export cave.db -o survey --format survex,therion\n"
      "The map of a run is map.db in its folder.");
}

}  // namespace lodeline
