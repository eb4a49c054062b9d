// lodeline_ros: the estimator as a ROS 1 node (docs/reference/ros-node.md).

#include <fmt/core.h>
#include <glog/logging.h>
#include <ros/ros.h>

#include <atomic>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "lodeline/diagnostics.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/pipeline/run_report.h"
#include "lodeline/pipeline/run_session.h"
#include "lodeline/pipeline/stop_request.h"
#include "lodeline_ros/estimate_publisher.h"
#include "lodeline_ros/node_parameters.h"
#include "lodeline_ros/node_status.h"
#include "lodeline_ros/sensor_intake.h"

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

/// Closes the source when the user or ROS's master ends the node, so that threads that wait for readings
/// continue.
class EndWatch {
 public:
  explicit EndWatch(LiveSource* source)
      : thread_([this, source] {
          while (!over_ && !stop_.made() && ros::ok()) std::this_thread::sleep_for(kPause);
          source->close();
        }) {}
  ~EndWatch() {
    over_ = true;
    thread_.join();
  }
  EndWatch(const EndWatch&) = delete;
  EndWatch& operator=(const EndWatch&) = delete;

 private:
  static constexpr std::chrono::milliseconds kPause{20};

  StopRequest stop_;
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

/// Runs the estimator on its own thread until the source ends.
void estimate(LiveSource* source, RunSession* session, EstimatePublisher* publisher, NodeStatus* status,
              const Diagnostics& diagnostics) {
  const double period_s = 1.0 / source->rig().cameras.front().rate_hz;
  constexpr int kFramesBetweenFindings = 20;
  while (session->fetch()) {
    const Clock::time_point start = Clock::now();
    session->process();
    publisher->publish(session->packet(), session->estimate(), session->odometry(), source->rig().imu,
                       session->mapFromOdom());
    const double work_s = std::chrono::duration<double>(Clock::now() - start).count();
    status->add(session->estimate(), work_s, period_s, source->backlog());
    if (session->summary().frames() % kFramesBetweenFindings == 0) status->setFindings(diagnostics.ranked());
  }
}

std::string inWords(const std::map<std::string, std::string>& topics) {
  std::string text = "ROS topics";
  for (const auto& [sensor, topic] : topics) text += fmt::format(" {}={}", sensor, topic);
  return text;
}

void complete(const NodeParameters& parameters, const RunSummary& summary, const Diagnostics& diagnostics) {
  fmt::print("{}", summary.text(diagnostics));
  if (parameters.run.output.empty()) return;
  if (parameters.report && summary.posed() > 0) {
    const std::string remark = writeRunReport(parameters.run);
    if (!remark.empty()) fmt::print("  {:<20} {}\n", "report", remark);
  }
  fmt::print("written to {}\n", parameters.run.output);
}

void runNode() {
  if (!ros::master::check()) {
    throw UsageError(fmt::format("no ROS master answers at {}; start roscore", ros::master::getURI()));
  }
  ros::NodeHandle node;
  ros::NodeHandle private_node("~");
  NodeParameters parameters = readNodeParameters(private_node);

  RunSettings options;
  options.synchronizer.prefetch = false;  // prefetching would delay every frame until the next one arrives
  Settings settings;
  applyRequest(parameters.run, &settings, &options);
  Diagnostics diagnostics;
  const RigFile rig_file = readRigFiles(parameters.rig_files, &diagnostics);
  if (!rig_file.has_imu)
    throw InputError("~rig: no file has a section imu0 (or Kalibr's imu.yaml is missing)");
  Rig rig = rig_file.rig;
  if (rig.cameras.empty()) throw InputError("~rig: no file describes a camera");
  selectCameras(options.source.camera_indices, "~rig", &rig);
  const std::map<std::string, std::string> topics = chooseLiveTopics(rig_file, parameters.topics, &rig);
  parameters.run.data = inWords(topics);
  parameters.run.sample_pictures = parameters.report;

  parameters.source.imu_correction = rig_file.imu_correction;
  LiveSource source(rig, parameters.source, &diagnostics);
  const EndWatch watch(&source);
  const SensorIntake intake(node, topics, rig_file.water, &source);
  EstimatePublisher publisher(private_node, parameters.frames, parameters.publish_tf);
  NodeStatus status;
  ros::Publisher diagnostics_topic = node.advertise<message::DiagnosticArray>("/diagnostics", 10);
  const ros::WallTimer timer = node.createWallTimer(ros::WallDuration(1.0), [&](const ros::WallTimerEvent&) {
    diagnostics_topic.publish(status.message(ros::Time::now(), source.unheard()));
  });
  ros::AsyncSpinner spinner(1);
  spinner.start();
  ROS_INFO("%s", parameters.run.data.c_str());

  if (!source.settleRates()) {
    ROS_WARN("ended before all sensors were heard");
    return;
  }
  RunSession session(parameters.run, settings, options, &source, &diagnostics);
  estimate(&source, &session, &publisher, &status, diagnostics);
  spinner.stop();
  complete(parameters, session.finish(), diagnostics);
}

int fail(const char* kind, const std::exception& error, int code) {
  // ROS's log cannot be used, because it ends with the last handle.
  fmt::print(stderr, "{}: {}\n", kind, error.what());
  return code;
}

}  // namespace
}  // namespace lodeline

int main(int argc, char** argv) {
  FLAGS_logtostderr = true;
  FLAGS_minloglevel = google::GLOG_ERROR;  // as in the program `lodeline`
  google::InitGoogleLogging(argv[0]);
  cv::setNumThreads(1);  // the same bytes on every machine
  ros::init(argc, argv, "lodeline", ros::init_options::NoSigintHandler);
  try {
    lodeline::runNode();
    return 0;
  } catch (const lodeline::InputError& error) {
    return lodeline::fail("bad input", error, 1);
  } catch (const lodeline::UsageError& error) {
    return lodeline::fail("bad usage", error, 2);
  } catch (const std::exception& error) {
    return lodeline::fail("estimation failed", error, 3);
  }
}
