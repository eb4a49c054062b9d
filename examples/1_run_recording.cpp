// Reads a recording in the EuRoC layout, estimates its trajectory and prints it in TUM's layout:
//   example_1_run_recording FOLDER > trajectory.tum

#include <cstdio>
#include <exception>

#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER_WITH_MAV0\n", argv[0]);
    return 2;
  }
  // Collects all problems of the recording.
  lodeline::Diagnostics diagnostics;

  // The source returns each sensor's readings as stored; the synchronizer makes one packet per image.
  lodeline::EurocSource source(argv[1], {}, &diagnostics);
  lodeline::Synchronizer synchronizer(&source, {}, &diagnostics);
  lodeline::Odometry odometry(source.rig(), {}, &diagnostics);

  int posed = 0;
  while (const auto packet = synchronizer.next()) {
    const lodeline::FrameEstimate estimate = odometry.add(*packet);
    if (estimate.status == lodeline::Status::Waiting) {
      std::fprintf(stderr, "waiting for %s\n", estimate.waiting_for.c_str());
      continue;
    }
    const lodeline::Rigid3& pose = estimate.state.world_from_body;
    const lodeline::Vec3& p = pose.translation;
    const lodeline::Quat& q = pose.rotation;
    std::printf("%.9f %.6f %.6f %.6f %.7f %.7f %.7f %.7f\n", estimate.time.seconds(), p.x(), p.y(), p.z(),
                q.x(), q.y(), q.z(), q.w());
    ++posed;
  }
  for (const lodeline::Finding& finding : diagnostics.ranked()) {
    std::fprintf(stderr, "%s (%d times)\n", finding.first_message.c_str(), finding.count);
  }
  std::fprintf(stderr, "%d poses\n", posed);
  return posed > 0 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
