#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/output/live/live_server.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/rig.h"

namespace lodeline {

class FrontEnd;

/// The page before any data arrives. `camera_axis_B`: viewing direction of the first camera. Throws
/// UsageError where the program was built without the page.
std::string livePage(const std::string& name, const std::string& data, const Vec3& camera_axis_B);

/// Message to the browser on a frame, in JSON (`State` in web/src/live.ts). `landmarks_W`: new ones, m.
/// `map_from_world`: by the map of the run, empty where there is none.
std::string liveState(const FrameEstimate& estimate, const RunSummary& summary, double t_s,
                      const std::vector<Eigen::Vector3f>& landmarks_W = {},
                      const std::optional<Rigid3>& map_from_world = std::nullopt);

/// Shows a run in the browser while it is in progress: the state of the newest frame a few times per second,
/// its image with the tracks less often. It does not influence the run, except for the computing time.
class LiveView {
 public:
  /// `name` of the run and `data` it reads, for the page. Throws UsageError where the port is not available
  /// or the program was built without the page.
  LiveView(const std::string& address, int port, const std::string& name, const std::string& data,
           const Rig& rig);
  /// Informs browsers that the run has ended.
  ~LiveView();

  std::string url() const { return server_.url(); }
  bool isWatched() const { return server_.isWatched(); }

  /// To be called after each frame, with the landmarks that left the window, and the odometry's world in the
  /// map if any; does nothing for most frames.
  void show(const FramePacket& packet, const FrameEstimate& estimate, const RunSummary& summary,
            const FrontEnd& front_end, const std::vector<MapPoint>& landmarks,
            const std::optional<Rigid3>& map_from_world = std::nullopt);

 private:
  std::vector<Eigen::Vector3f> takeLandmarks();

  using Clock = std::chrono::steady_clock;

  LiveServer server_;
  Clock::time_point next_state_ = Clock::now();
  Clock::time_point next_picture_ = Clock::now();
  std::optional<Time> first_time_;
  std::vector<Eigen::Vector3f> landmarks_W_;  ///< not yet sent
};

}  // namespace lodeline
