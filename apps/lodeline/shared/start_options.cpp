#include "apps/lodeline/shared/start_options.h"

namespace lodeline {

std::optional<DiveStart> StartArguments::start() const {
  if (position_m.empty()) return std::nullopt;
  const DiveStart start{{position_m[0], position_m[1], position_m[2]}, sigmas_m[0], sigmas_m[1]};
  start.check();
  return start;
}

CLI::Option* addStartOptions(StartArguments* arguments, CLI::App* command) {
  CLI::Option* start =
      command
          ->add_option("--start", arguments->position_m,
                       "start of the dive from the origin of the map, such as a GPS fix: EAST,NORTH,UP (m)")
          ->delimiter(',')
          ->expected(3);
  command
      ->add_option("--start-sigma", arguments->sigmas_m, "one sigma of that start: HORIZONTAL,VERTICAL (m)")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  return start;
}

}  // namespace lodeline
