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
                       "EAST,NORTH,UP (m from the map's origin) at which the dive began, as by a GPS fix")
          ->delimiter(',')
          ->expected(3);
  command->add_option("--start-sigma", arguments->sigmas_m, "HORIZONTAL,VERTICAL (m): how well that is known")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  return start;
}

}  // namespace lodeline
