// Reads a recording in the EuRoC layout, estimates its trajectory and prints it in TUM's layout:
//   example_1_run_recording FOLDER [SECONDS] > trajectory.tum

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "lodeline/odometry.h"

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s FOLDER_WITH_MAV0 [SECONDS]\n", argv[0]);
    return 2;
  }
  // Collects all problems of the recording.
  lodeline::Diagnostics diagnostics;
  lodeline::OdometrySettings settings;
  if (argc > 2) settings.set("source.duration_s", argv[2]);

  const auto open = [&](lodeline::Diagnostics* findings) {
    return lodeline::openEuroc(argv[1], settings.recording(), findings);
  };
  settings.adaptTo(open, argv[1], &diagnostics);
  const auto source = open(&diagnostics);
  lodeline::Odometry odometry(source.get(), settings, &diagnostics);

  int poses = 0;
  while (const auto estimate = odometry.next()) {
    if (estimate->status == lodeline::Status::Waiting) {
      std::fprintf(stderr, "waiting for %s\n", estimate->waiting_for.c_str());
      continue;
    }
    const lodeline::Rigid3& pose = estimate->state.world_from_body;
    const lodeline::Vec3& p = pose.translation;
    const lodeline::Quat& q = pose.rotation;
    // A double would round the nanoseconds of a time since 1970.
    const std::lldiv_t stamp = std::lldiv(estimate->time.nanoseconds(), 1'000'000'000);
    std::printf("%lld.%09lld %.6f %.6f %.6f %.7f %.7f %.7f %.7f\n", stamp.quot, stamp.rem, p.x(), p.y(),
                p.z(), q.x(), q.y(), q.z(), q.w());
    ++poses;
  }
  for (const lodeline::Finding& finding : diagnostics.ranked()) {
    std::fprintf(stderr, "%s (%d times)\n", finding.first_message.c_str(), finding.count);
  }
  std::fprintf(stderr, "%d poses\n", poses);
  return poses > 0 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
