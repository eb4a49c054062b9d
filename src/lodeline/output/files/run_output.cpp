#include "lodeline/output/files/run_output.h"

#include "lodeline/util/thread_clock.h"

namespace lodeline {

RunOutput::RunOutput(const std::filesystem::path& folder, const Estimator& estimator,
                     const RunOutputOptions& options)
    : folder_(folder), landmarks_(folder), timings_(folder) {
  states_.emplace(folder, "", estimator.sensorColumns());
  const Rig& rig = estimator.rig();
  if (rig.magnetometer) magnetometer_.emplace(folder, *rig.magnetometer);
  if (options.draw_tracks_s) track_pictures_.emplace(folder, *options.draw_tracks_s);
  if (options.sample_pictures) sample_pictures_.emplace(folder);
}

std::vector<MapPoint> RunOutput::write(const FramePacket& packet, const FrameEstimate* estimate,
                                       const std::optional<AttitudeEstimate>& attitude,
                                       PacketOdometry* odometry) {
  if (estimate != nullptr) states_->write(*estimate, attitude);
  std::vector<MapPoint> finished = odometry->estimator().takeMapPoints();
  landmarks_.write(finished);
  if (magnetometer_) magnetometer_->write(packet);
  const double start_s = threadSeconds();
  if (track_pictures_) track_pictures_->write(packet, odometry->frontEnd());
  if (sample_pictures_) sample_pictures_->write(packet, odometry->frontEnd());
  pictures_s_ += threadSeconds() - start_s;
  timings_.write(packet.time, odometry->times(), pictures_s_);
  return finished;
}

int64_t RunOutput::finish(const PacketOdometry& odometry, const MagnetometerEstimate& last) {
  const std::optional<WorldTurn> turn = WorldTurn::of(last);
  landmarks_.write(odometry.estimator().currentMapPoints());
  landmarks_.finish(last.heading_reference, turn);
  states_.reset();
  if (turn) turnStateFiles(folder_, "", *turn);
  return landmarks_.count();
}

}  // namespace lodeline
