#include <chrono>

#include "lodeline/api/odometry_implementation.h"
#include "lodeline/live.h"
#include "lodeline/output/live/live_view.h"

namespace lodeline {

struct LivePage::Implementation {
  LiveView view;
  RunSummary summary = RunSummary();
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

LivePage::LivePage(const Rig& rig, const LivePageOptions& options) {
  if (rig.cameras.empty()) throw InputError("live page: the rig has no camera");
  implementation_.reset(new Implementation{{options.address, options.port, options.name, options.data, rig}});
}
LivePage::~LivePage() = default;
LivePage::LivePage(LivePage&&) noexcept = default;
LivePage& LivePage::operator=(LivePage&&) noexcept = default;

std::string LivePage::url() const { return implementation_->view.url(); }

void LivePage::show(const Odometry& odometry, const FrameEstimate& estimate,
                    const std::vector<MapPoint>& landmarks) {
  RunSummary& summary = implementation_->summary;
  summary.add(estimate);
  summary.wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - implementation_->start).count();
  const EstimationLoop& loop = odometry.implementation().loop;
  implementation_->view.show(loop.packet(), estimate, summary, loop.odometry().frontEnd(), landmarks);
}

}  // namespace lodeline
