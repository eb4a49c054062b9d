// Estimates the trajectory of a recording, refines it with all measurements at once, and writes a survey of
// it for Survex and as a table:
//   example_3_refine_and_survey FOLDER OUTPUT [SECONDS]

#include <cstdio>
#include <exception>

#include "lodeline/odometry.h"
#include "lodeline/survey.h"

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s FOLDER_WITH_MAV0 OUTPUT [SECONDS]\n", argv[0]);
    return 2;
  }
  lodeline::Diagnostics diagnostics;
  lodeline::OdometrySettings settings;
  if (argc > 3) settings.set("source.duration_s", argv[3]);
  const auto source = lodeline::openEuroc(argv[1], settings.recording(), &diagnostics);
  lodeline::Odometry odometry(source.get(), settings, &diagnostics);
  odometry.keepForRefinement();
  while (odometry.next()) {
  }

  const lodeline::Refinement refinement = odometry.refine();
  if (!refinement.summary.usable()) {
    std::fprintf(stderr, "not refined: %s\n", refinement.summary.refusal.c_str());
    return 3;
  }
  std::printf("%d states, %lld landmarks, positions moved by %.3f m (RMS)\n", refinement.summary.states,
              static_cast<long long>(refinement.summary.landmarks), refinement.summary.moved_rms_m);
  const lodeline::RunFolder run = lodeline::runOf("dive", refinement.frames, refinement.landmarks);
  lodeline::DiveMapOptions options;
  options.stations.spacing_m = 1.0;
  for (const auto& file : lodeline::writeSurvey(
           run, options, {lodeline::MapFormat::Survex, lodeline::MapFormat::Csv}, argv[2], &diagnostics)) {
    std::printf("%s\n", file.c_str());
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
