#include "lodeline/node/ros_session.h"

#include <fmt/format.h>

#include <chrono>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/node/estimate_publisher.h"
#include "lodeline/node/intake/message_intake.h"
#include "lodeline/node/node_settings.h"
#include "lodeline/node/node_status.h"
#include "lodeline/pipeline/output_choice.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/pipeline/run_report.h"
#include "lodeline/pipeline/run_session.h"

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

// Messages that may wait until the transport's thread takes them; that thread never waits.
constexpr int kImagesWaiting = 60;
constexpr int kReadingsWaiting = 2000;

std::string inWords(const std::vector<SensorTopic>& topics) {
  std::string text = "ROS topics";
  for (const SensorTopic& topic : topics) text += fmt::format(" {}={}", topic.sensor, topic.topic);
  return text;
}

std::vector<RosSession::Subscription> described(const std::vector<SensorTopic>& topics,
                                                const NodeSettings& settings) {
  std::vector<RosSession::Subscription> subscriptions;
  for (const SensorTopic& topic : topics) {
    const SensorQos qos = settings.qosOf(topic.sensor);
    const int usual_depth = topic.isCamera() ? kImagesWaiting : kReadingsWaiting;
    RosSession::Subscription& subscription = subscriptions.emplace_back();
    subscription = {topic.sensor, topic.topic, {}, qos.is_reliable, qos.depth > 0 ? qos.depth : usual_depth};
    for (const messages::Type& type : topic.types) subscription.types.emplace_back(type.name);
  }
  return subscriptions;
}

}  // namespace

class RosSession::Content {
 public:
  Content(const OptionValues& options, Encoding encoding);

  bool run(const Publish& publish);
  std::string finish();
  void publishDiagnostics(int64_t now_ns, const Publish& publish);

  MessageIntake& intake() { return *intake_; }
  LiveSource& source() { return *source_; }
  const std::vector<Subscription>& subscriptions() const { return subscriptions_; }
  const std::vector<Publication>& publications() const { return publications_; }
  const std::string& description() const { return settings_.run.data; }

 private:
  void estimate(const Publish& publish);

  NodeSettings settings_;
  Serialization serialization_;
  Diagnostics diagnostics_;
  RunSettings run_options_;
  Settings run_settings_;
  std::optional<LiveSource> source_;
  std::optional<MessageIntake> intake_;
  std::vector<Subscription> subscriptions_;
  std::vector<Publication> publications_;
  NodeStatus status_;
  std::optional<RunSession> session_;
};

RosSession::Content::Content(const OptionValues& options, Encoding encoding)
    : settings_(readNodeSettings(options)),
      serialization_(encoding == Encoding::Ros1 ? Serialization::Ros1 : Serialization::Cdr) {
  RunRequest& request = settings_.run;
  if (!request.output.empty() && !request.overwrite) refuseToReplaceRun(request.output);
  run_options_.synchronizer.prefetch = false;  // prefetching would delay every frame until the next one
  applyRequest(request, &run_settings_, &run_options_);
  const std::vector<std::filesystem::path> files(settings_.rig_files.begin(), settings_.rig_files.end());
  const RigFile rig_file = readRigFiles(files, &diagnostics_);
  if (!rig_file.has_imu)
    throw InputError("rig: no file has a section imu0 (or Kalibr's imu.yaml is missing)");
  Rig rig = rig_file.rig;
  if (rig.cameras.empty()) throw InputError("rig: no file describes a camera");
  selectCameras(run_options_.source.camera_indices, "rig", &rig);
  const auto topics = subscriptionsOf(chooseLiveTopics(rig_file, settings_.topicsBySensor(), &rig));
  request.data = inWords(topics);
  request.sample_pictures = settings_.report;
  settings_.source.imu_correction = rig_file.imu_correction;
  source_.emplace(rig, settings_.source, &diagnostics_);
  intake_.emplace(topics, rig_file.water, serialization_, &*source_);
  subscriptions_ = described(topics, settings_);
  for (const auto& topic : lodeline::publications(settings_.publish_tf)) {
    publications_.push_back({topic.topic, topic.type, topic.depth, topic.is_latched});
  }
}

bool RosSession::Content::run(const Publish& publish) {
  cv::setNumThreads(1);  // the same bytes on every machine
  if (!source_->settleRates()) return false;
  session_.emplace(settings_.run, run_settings_, run_options_, &*source_, &diagnostics_);
  estimate(publish);
  return true;
}

void RosSession::Content::estimate(const Publish& publish) {
  const double period_s = 1.0 / source_->rig().cameras.front().rate_hz;
  EstimatePublisher publisher(
      settings_.frames, settings_.publish_tf, serialization_,
      [&](Output output, wire::Bytes message) { publish(static_cast<size_t>(output), std::move(message)); });
  while (session_->fetch()) {
    const Clock::time_point start = Clock::now();
    session_->process();
    publisher.publish(session_->packet(), session_->estimate(), session_->odometry(), source_->rig().imu,
                      session_->mapFromOdom());
    const double work_s = std::chrono::duration<double>(Clock::now() - start).count();
    status_.add(session_->estimate(), work_s, period_s, source_->backlog());
    status_.setFindings(diagnostics_.ranked());
  }
}

std::string RosSession::Content::finish() {
  if (!session_) return "ended before all sensors were heard\n";
  const RunSummary summary = session_->finish();
  std::string text = summary.text(diagnostics_);
  session_.reset();
  if (settings_.run.output.empty()) return text;
  if (settings_.report && summary.posed() > 0) {
    const std::string remark = writeRunReport(settings_.run);
    if (!remark.empty()) text += fmt::format("  {:<20} {}\n", "report", remark);
  }
  return text + fmt::format("written to {}\n", settings_.run.output);
}

void RosSession::Content::publishDiagnostics(int64_t now_ns, const Publish& publish) {
  const auto statuses = status_.statuses(source_->unheard(), intake_->traffic());
  publish(static_cast<size_t>(Output::Diagnostics),
          diagnosticsMessage(Time::fromNanoseconds(now_ns), statuses, serialization_));
}

RosSession::RosSession(const OptionValues& options, Encoding encoding)
    : content_(std::make_unique<Content>(options, encoding)) {}
RosSession::~RosSession() = default;

const std::vector<RosSession::Subscription>& RosSession::subscriptions() const {
  return content_->subscriptions();
}
const std::vector<RosSession::Publication>& RosSession::publications() const {
  return content_->publications();
}
std::string RosSession::description() const { return content_->description(); }

void RosSession::receive(size_t subscription, const std::string& type, Bytes message,
                         const std::string& md5sum) {
  content_->intake().receive(subscription, type, md5sum, std::move(message));
}
void RosSession::addLost(size_t subscription, uint64_t messages) {
  content_->intake().addLost(subscription, messages);
}
void RosSession::addProblem(size_t subscription, const std::string& problem) {
  content_->intake().addProblem(subscription, problem);
}
RosSession::Traffic RosSession::traffic(size_t subscription) const {
  const SensorTraffic traffic = content_->intake().traffic().at(subscription);
  return {traffic.received, traffic.lost, traffic.unusable};
}

bool RosSession::run(const Publish& publish) { return content_->run(publish); }
void RosSession::close() { content_->source().close(); }
std::string RosSession::finish() { return content_->finish(); }
void RosSession::publishDiagnostics(int64_t now_ns, const Publish& publish) {
  content_->publishDiagnostics(now_ns, publish);
}

}  // namespace lodeline
