#include "lodeline_ros/node_status.h"

#include <fmt/format.h>

#include <numbers>

namespace lodeline {
namespace {

using message::DiagnosticStatus;

constexpr double kStale_s = 2.0;
/// Weight of a new frame in the mean, which covers about 50 frames.
constexpr double kNewest = 0.02;

void addValue(const char* key, std::string value, DiagnosticStatus* status) {
  message::KeyValue pair;
  pair.key = key;
  pair.value = std::move(value);
  status->values.push_back(std::move(pair));
}

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

message::DiagnosticArray NodeStatus::message(ros::Time now, const std::vector<std::string>& unheard) const {
  const std::lock_guard lock(mutex_);
  message::DiagnosticArray array;
  array.header.stamp = now;
  array.status = {estimatorStatus(unheard), magnetometerStatus()};
  return array;
}

DiagnosticStatus NodeStatus::estimatorStatus(const std::vector<std::string>& unheard) const {
  DiagnosticStatus status;
  status.name = "lodeline: estimator";
  status.level = DiagnosticStatus::WARN;
  if (!last_) {
    status.message = unheard.empty() ? "waiting for a frame"
                                     : fmt::format("waiting for messages of {}", fmt::join(unheard, ", "));
    return status;
  }
  const double silence_s = std::chrono::duration<double>(Clock::now() - last_time_).count();
  status.message = last_->status == Status::Waiting ? "waiting for " + last_->waiting_for
                                                    : std::string(toString(last_->status));
  if (last_->status == Status::Tracking) status.level = DiagnosticStatus::OK;
  if (silence_s > kStale_s) {
    status.level = DiagnosticStatus::ERROR;
    status.message = fmt::format("no frame for {:.0f} s; do images and inertial readings come?", silence_s);
  }
  addValue("status", toString(last_->status), &status);
  addValue("frames", std::to_string(frames_), &status);
  addValue("tracks", std::to_string(last_->tracks), &status);
  addValue("landmarks", std::to_string(last_->landmarks), &status);
  addValue("reprojection rms [sigma]", fmt::format("{:.2f}", last_->reprojection_rms_sigmas), &status);
  addValue("ratio to real time", busy_share_ > 0.0 ? fmt::format("{:.1f}", 1.0 / busy_share_) : "", &status);
  addValue("images waiting", std::to_string(backlog_), &status);
  addValue("depth", toString(last_->sensors.of<DepthEstimate>().status), &status);
  for (const Finding& finding : findings_) {
    if (finding.severity == Severity::Notice) continue;
    addValue(finding.kind.c_str(), fmt::format("{} x, first: {}", finding.count, finding.first_message),
             &status);
  }
  return status;
}

DiagnosticStatus NodeStatus::magnetometerStatus() const {
  DiagnosticStatus status;
  status.name = "lodeline: magnetometer";
  status.level = DiagnosticStatus::OK;
  if (!last_) return status;
  const MagnetometerEstimate& magnetometer = last_->sensors.of<MagnetometerEstimate>();
  status.message = toString(magnetometer.status);
  if (isRejected(magnetometer.status)) status.level = DiagnosticStatus::WARN;
  addValue("gate", toString(magnetometer.status), &status);
  addValue("heading reference", toString(magnetometer.heading_reference), &status);
  if (magnetometer.north_from_world_rad) {
    addValue("north from world [deg]",
             fmt::format("{:.2f}", *magnetometer.north_from_world_rad * 180.0 / std::numbers::pi), &status);
  }
  addValue("heading sigma [deg]",
           fmt::format("{:.2f}", magnetometer.heading_sigma_rad * 180.0 / std::numbers::pi), &status);
  return status;
}

}  // namespace lodeline
