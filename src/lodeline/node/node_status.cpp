#include "lodeline/node/node_status.h"

#include <fmt/format.h>

#include <numbers>

namespace lodeline {
namespace {

constexpr double kStale_s = 2.0;
/// Weight of a new frame in the mean, which covers about 50 frames.
constexpr double kNewest = 0.02;

bool isRejected(MagnetometerStatus status) {
  return status == MagnetometerStatus::Norm || status == MagnetometerStatus::Dip ||
         status == MagnetometerStatus::Innovation || status == MagnetometerStatus::Inconsistent;
}

}  // namespace

void NodeStatus::add(const FrameEstimate& estimate, double work_s, double period_s, size_t backlog) {
  const std::lock_guard lock(mutex_);
  const double share = work_s / period_s;
  busy_share_ = last_ ? (1.0 - kNewest) * busy_share_ + kNewest * share : share;
  last_ = estimate;
  last_time_ = Clock::now();
  backlog_ = backlog;
  ++frames_;
}

void NodeStatus::setFindings(std::vector<Finding> findings) {
  const std::lock_guard lock(mutex_);
  findings_ = std::move(findings);
}

std::vector<DiagnosticStatus> NodeStatus::statuses(const std::vector<std::string>& unheard,
                                                   const std::vector<SensorTraffic>& traffic) {
  const std::lock_guard lock(mutex_);
  return {estimatorStatus(unheard), magnetometerStatus(), sensorsStatus(traffic)};
}

DiagnosticStatus NodeStatus::estimatorStatus(const std::vector<std::string>& unheard) const {
  DiagnosticStatus status;
  status.name = "lodeline: estimator";
  status.level = DiagnosticStatus::kWarn;
  if (!last_) {
    status.message = unheard.empty() ? "waiting for a frame"
                                     : fmt::format("waiting for messages of {}", fmt::join(unheard, ", "));
    return status;
  }
  const double silence_s = std::chrono::duration<double>(Clock::now() - last_time_).count();
  status.message = last_->status == Status::Waiting ? "waiting for " + last_->waiting_for
                                                    : std::string(toString(last_->status));
  if (last_->status == Status::Tracking) status.level = DiagnosticStatus::kOk;
  if (silence_s > kStale_s) {
    status.level = DiagnosticStatus::kError;
    status.message = fmt::format("no frame for {:.0f} s; do images and inertial readings come?", silence_s);
  }
  status.add("status", toString(last_->status));
  status.add("frames", std::to_string(frames_));
  status.add("tracks", std::to_string(last_->tracks));
  status.add("landmarks", std::to_string(last_->landmarks));
  status.add("reprojection rms [sigma]", fmt::format("{:.2f}", last_->reprojection_rms_sigmas));
  status.add("ratio to real time", busy_share_ > 0.0 ? fmt::format("{:.1f}", 1.0 / busy_share_) : "");
  status.add("images waiting", std::to_string(backlog_));
  status.add("depth", toString(last_->sensors.of<DepthEstimate>().status));
  for (const Finding& finding : findings_) {
    if (finding.severity == Severity::Notice) continue;
    status.add(finding.kind, fmt::format("{} x, first: {}", finding.count, finding.first_message));
  }
  return status;
}

DiagnosticStatus NodeStatus::magnetometerStatus() const {
  DiagnosticStatus status;
  status.name = "lodeline: magnetometer";
  status.level = DiagnosticStatus::kOk;
  if (!last_) return status;
  const MagnetometerEstimate& magnetometer = last_->sensors.of<MagnetometerEstimate>();
  status.message = toString(magnetometer.status);
  if (isRejected(magnetometer.status)) status.level = DiagnosticStatus::kWarn;
  status.add("gate", toString(magnetometer.status));
  status.add("heading reference", toString(magnetometer.heading_reference));
  if (magnetometer.north_from_world_rad) {
    status.add("north from world [deg]",
               fmt::format("{:.2f}", *magnetometer.north_from_world_rad * 180.0 / std::numbers::pi));
  }
  status.add("heading sigma [deg]",
             fmt::format("{:.2f}", magnetometer.heading_sigma_rad * 180.0 / std::numbers::pi));
  return status;
}

DiagnosticStatus NodeStatus::sensorsStatus(const std::vector<SensorTraffic>& traffic) {
  DiagnosticStatus status;
  status.name = "lodeline: sensors";
  status.message = "messages arrive";
  uint64_t losses = 0;
  std::string problem, silence;
  for (const SensorTraffic& sensor : traffic) {
    losses += sensor.lost + sensor.unusable;
    if (sensor.received == 0) silence = sensor.topic + ": no message yet";
    if (!sensor.problem.empty()) problem = fmt::format("{}: a message {}", sensor.topic, sensor.problem);
    const std::string why = sensor.problem.empty() ? "" : ": " + sensor.problem;
    status.add(fmt::format("{} {}", sensor.sensor, sensor.topic),
               fmt::format("{} received, {} lost, {} of no use{}", sensor.received, sensor.lost,
                           sensor.unusable, why));
  }
  if (losses > told_losses_) {
    status.level = DiagnosticStatus::kWarn;
    status.message = fmt::format("{} messages lost or of no use", losses - told_losses_);
    if (!problem.empty()) status.message += "; " + problem;
  } else if (!problem.empty() || !silence.empty()) {
    // A sensor that has never been heard may be silent for a good reason; a fault in the past is reported.
    status.message = problem.empty() ? silence : problem;
  }
  told_losses_ = losses;
  return status;
}

}  // namespace lodeline
