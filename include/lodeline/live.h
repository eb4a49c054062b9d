#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/odometry.h"
#include "lodeline/rig.h"

namespace lodeline {

/// What LivePage shows, and where.
struct LivePageOptions {
  std::string name = "run";           ///< of the run, for the page
  std::string data;                   ///< what is read, in words
  std::string address = "127.0.0.1";  ///< 0.0.0.0 lets other machines see the page
  int port = 0;                       ///< 0 for any free port
};

/// Shows the odometry in the browser while it goes on: the path, the state, and the newest image with its
/// tracks. It changes no estimate.
class LivePage {
 public:
  /// Throws UsageError where the port is not available or the library was built without the page.
  LivePage(const Rig& rig, const LivePageOptions& options);
  ~LivePage();
  LivePage(LivePage&&) noexcept;
  LivePage& operator=(LivePage&&) noexcept;

  std::string url() const;

  /// To be called after each Odometry::next(), with its estimate and the landmarks that it took; does little
  /// for most of them.
  void show(const Odometry& odometry, const FrameEstimate& estimate, const std::vector<MapPoint>& landmarks);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lodeline
