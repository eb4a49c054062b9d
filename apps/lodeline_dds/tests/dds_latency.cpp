// How long after its image a pose comes: plays a bag of ROS 2 over DDS at the pace of its recording, with
// lodeline_dds in another process, and prints the delays.
//
//   dds_latency BAG RIG [SECONDS]

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "apps/lodeline_dds/tests/test_player.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/util/files/test_process.h"

namespace lodeline::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kOdometry = "/lodeline/odometry";

/// The run begins when rates are measured, a second of images later, and then catches up.
constexpr double kStart_s = 4.0;

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

/// When an image was to be published, and when it was.
struct Publication {
  Clock::time_point due, done;
};

double milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

/// Publishes at the pace of the recording. Returns the publication of each image of the first camera.
std::map<Time, Publication> play(const std::string& first_camera, double duration_s, TestPlayer* player) {
  std::map<Time, Publication> published;
  const Time first = player->messages().front().received;
  const Clock::time_point start = Clock::now();
  for (const TestPlayer::Message& message : player->messages()) {
    const double time_s = (message.received - first).seconds();
    if (time_s > duration_s) break;
    const Clock::time_point due =
        start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(time_s));
    std::this_thread::sleep_until(due);
    player->publish(message);
    if (message.topic == first_camera) published[message.received] = {due, Clock::now()};
  }
  return published;
}

int measure(const std::string& bag, const std::string& rig, double duration_s) {
  dds::NetworkOptions network;
  network.domain = 1 + static_cast<int>(getpid()) % 100;
  std::vector<std::string> topics;
  Diagnostics diagnostics;
  for (const auto& [sensor, topic] : readRigFiles({rig}, &diagnostics).topics) topics.push_back(topic);
  TestPlayer player(bag, network, false, topics);
  player.hear(kOdometry, "nav_msgs/Odometry");
  ChildProcess node({LODELINE_DDS, "--rig", rig, "--domain", std::to_string(network.domain)},
                    "dds_latency.log");
  if (!player.waitForSubscribers(30.0)) {
    fmt::print(stderr, "lodeline_dds does not subscribe to every topic; dds_latency.log says why\n");
    return 1;
  }
  const auto published = play(imageTopicsOf(bag).front(), duration_s, &player);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  std::vector<double> delays_ms;
  size_t in_time = 0;
  for (const TestPlayer::Heard& pose : player.heard(kOdometry)) {
    // The clocks of camera and IMU differ by less than half the time between images.
    const auto after = published.upper_bound(stampOfCdr(pose.cdr) + Duration::fromSeconds(0.02));
    if (after == published.begin()) continue;
    const auto image = std::prev(after);
    const double time_s = (image->first - published.begin()->first).seconds();
    if (time_s < kStart_s) continue;
    delays_ms.push_back(milliseconds(pose.arrival - image->second.done));
    const auto second = after == published.end() ? after : std::next(after);
    const bool is_in_time = second == published.end() || pose.arrival < second->second.done;
    in_time += is_in_time ? 1 : 0;
    if (is_in_time) continue;
    fmt::print("late: image of {:.2f} s, pose after {:.1f} ms, next image {:.1f} ms behind its time\n",
               time_s, delays_ms.back(), milliseconds(after->second.done - after->second.due));
  }
  if (delays_ms.empty()) {
    fmt::print(stderr, "no pose came; dds_latency.log says why\n");
    return 1;
  }
  fmt::print("{} images, {} poses after the start; {:.1f} % before the second image after their own\n",
             published.size(), delays_ms.size(),
             100.0 * static_cast<double>(in_time) / static_cast<double>(delays_ms.size()));
  fmt::print("delay after the image: median {:.1f} ms, 95 % {:.1f} ms, greatest {:.1f} ms\n",
             percentile(delays_ms, 0.5), percentile(delays_ms, 0.95), percentile(delays_ms, 1.0));
  return 0;
}

}  // namespace
}  // namespace lodeline::test

int main(int argc, char** argv) {
  if (argc < 3 || argc > 4) {
    fmt::print(stderr, "dds_latency BAG RIG [SECONDS]\n");
    return 2;
  }
  return lodeline::test::measure(argv[1], argv[2], argc == 4 ? std::stod(argv[3]) : 1e9);
}
