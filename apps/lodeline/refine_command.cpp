#include "apps/lodeline/refine_command.h"

#include <memory>

#include "apps/lodeline/run_command.h"
#include "lodeline/batch/estimator_log.h"

namespace lodeline {

void addRefineCommand(CLI::App& program) {
  const auto arguments = std::make_shared<RunArguments>();
  RunRequest& request = arguments->request;
  request.refine_interval_s = EstimatorLog::kStateInterval_s;
  CLI::App* command = program.add_subcommand(
      "refine", "Run, then solve for the whole trajectory and map at once: the best there is for a survey");
  addRunOptions(arguments.get(), command);
  command
      ->add_option("--state-interval", *request.refine_interval_s,
                   "longest time between two states of the solution; 0 makes every image a state")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  lodeline refine dive1 -o dive1_result\n"
      "  lodeline refine dive1 -o dive1_result --mag-calibration mag.yaml\n"
      "  lodeline export dive1_result --format survex\n"
      "Results: those of `lodeline run`, and trajectory_refined.tum, states_refined.csv and "
      "landmarks_refined.ply.");
  command->callback([arguments] { executeRun(requestOf(*arguments)); });
}

}  // namespace lodeline
