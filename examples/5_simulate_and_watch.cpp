// Simulates a dive with images and exact truth, and shows the odometry on it in the browser:
//   example_5_simulate_and_watch OUTPUT [SECONDS]

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "lodeline/live.h"
#include "lodeline/odometry.h"
#include "lodeline/simulation.h"

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s OUTPUT [SECONDS]\n", argv[0]);
    return 2;
  }
  lodeline::ScenarioChanges changes;
  changes.seconds = argc > 2 ? std::atof(argv[2]) : 10.0;
  changes.width_px = 160;
  changes.camera_rate_hz = 5.0;
  const lodeline::Scenario scenario = lodeline::makeScenario("demo", changes);
  const lodeline::RecordingSummary recorded = lodeline::recordScenario(scenario, argv[1], {});
  std::printf("%.1f s, %.1f m, %zu images\n", recorded.duration_s, recorded.path_length_m,
              recorded.images.total);

  lodeline::Diagnostics diagnostics;
  const auto source = lodeline::openEuroc(argv[1], {}, &diagnostics);
  lodeline::LivePage page(source->rig(), {.name = scenario.name, .data = argv[1]});
  std::printf("live at %s\n", page.url().c_str());
  lodeline::Odometry odometry(source.get(), {}, &diagnostics);
  int frames = 0;
  for (; const auto estimate = odometry.next(); ++frames)
    page.show(odometry, *estimate, odometry.takeLandmarks());
  std::printf("%d frames\n", frames);
  return frames > 0 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
