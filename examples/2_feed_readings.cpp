// Feeds live readings to the odometry, which estimates on a second thread. The readings come from a recording
// and are fed faster than in real time:
//   example_2_feed_readings FOLDER [SECONDS]

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <thread>

#include "lodeline/odometry.h"

namespace {

/// Pushes all readings up to the time of an image, then the image.
void pushUpTo(lodeline::Time time, lodeline::RecordedSource* recording, lodeline::LiveSource* rig) {
  const lodeline::Time end = time + lodeline::Duration::fromSeconds(0.05);
  while (const auto sample = recording->nextImu()) {
    rig->push(*sample);
    if (sample->time > end) break;
  }
  while (const auto sample = recording->nextMagnetometer()) {
    rig->push(*sample);
    if (sample->time > end) break;
  }
  while (const auto sample = recording->nextDepth()) {
    rig->push(*sample);
    if (sample->time > end) break;
  }
}

void drive(lodeline::RecordedSource* recording, double seconds, lodeline::LiveSource* rig) {
  const size_t cameras = recording->rig().cameras.size();
  lodeline::Time first;
  for (int frame = 0; const auto image = recording->nextImage(0); ++frame) {
    if (frame == 0) first = image->time;
    if ((image->time - first).seconds() > seconds) break;
    // A camera's driver has the pixels in memory: rig->push(0, lodeline::imageInMemory(stamp, pixels)).
    rig->push(0, lodeline::imageInMemory(image->time, image->load().image));
    for (size_t camera = 1; camera < cameras; ++camera) {
      if (const auto other = recording->nextImage(camera)) rig->push(camera, *other);
    }
    pushUpTo(image->time, recording, rig);
    // The queue for images is short, so that a slow estimator stays near the present.
    while (rig->backlog() > 20) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  rig->close();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: %s FOLDER_WITH_MAV0 [SECONDS]\n", argv[0]);
    return 2;
  }
  lodeline::Diagnostics diagnostics;
  const auto recording = lodeline::openEuroc(argv[1], {}, &diagnostics);

  // The rig of drivers is read from calibration files: lodeline::readRig({"rig.yaml"}, &diagnostics).
  lodeline::LiveSourceOptions options;
  options.patience_s = 1.0;
  lodeline::LiveSource rig(recording->rig(), options, &diagnostics);
  std::thread drivers([&] { drive(recording.get(), argc > 2 ? std::atof(argv[2]) : 1e9, &rig); });

  lodeline::Odometry odometry(&rig, {}, &diagnostics);
  int poses = 0;
  double sigma_m = 0.0;
  while (const auto estimate = odometry.next()) {
    if (estimate->status == lodeline::Status::Waiting) continue;
    sigma_m = std::sqrt(estimate->covariance.topLeftCorner<3, 3>().trace());
    ++poses;
  }
  drivers.join();
  std::printf("%d poses, the last one known to %.3f m\n", poses, sigma_m);
  return poses > 0 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
