#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "lodeline/output/live/live_view.h"
#include "lodeline/output/report/page/test_browser.h"

// Tests of the page in headless Chromium during a run; web/test/live.mjs contains the checks.

namespace lodeline {
namespace {

/// Estimate of a swim to the east at 1 m/s, half a metre below the start, at the end by inertial readings.
/// North is found after six seconds: in the estimator's world, that of the first pose, it is along the x
/// axis.
FrameEstimate estimateAt(int second) {
  FrameEstimate estimate;
  estimate.time = Time::fromSeconds(second);
  estimate.status = second < 12 ? Status::Tracking : Status::Inertial;
  const double north_rad = 0.5 * M_PI;
  const Quat world_from_north(Eigen::AngleAxisd(-north_rad, Vec3::UnitZ()));
  estimate.state.world_from_body = Rigid3(world_from_north, world_from_north * Vec3(second, 0.0, -0.5));
  auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  if (second >= 6) {
    magnetometer.heading_reference = HeadingReference::True;
    magnetometer.north_from_world_rad = north_rad;
  }
  magnetometer.heading_sigma_rad = 2.0 * M_PI / 180.0;
  return estimate;
}

/// The map turns to north when it is found. A loop in the tenth second moves the dive by 3 m to the north.
Rigid3 mapFromWorldAt(int second) {
  const Quat north_from_world(Eigen::AngleAxisd(second < 6 ? 0.0 : 0.5 * M_PI, Vec3::UnitZ()));
  return {north_from_world, Vec3(0.0, second < 10 ? 0.0 : 3.0, 0.0)};
}

TEST(LiveBrowser, ShowsWhatIsTold) {
  if (const std::string missing = test::browserMissing(); !missing.empty()) GTEST_SKIP() << missing;
  bool passed = false;
  std::thread browser;
  {
    LiveServer server("127.0.0.1", 0, livePage("dive", "recording", Vec3::UnitX()));
    RunSummary summary;
    for (int second = 0; second <= 12; ++second) {
      FrameEstimate estimate = estimateAt(second);
      if (second > 0) summary.add(estimate);
      summary.wall_s = summary.recordingSeconds() / 1.5;
      server.sendAndKeep("state",
                         liveState(estimate, summary, second, {{1.0F, 2.0F, -0.5F}}, mapFromWorldAt(second)));
    }
    server.sendAndKeep("picture", R"({"t_s":12,"jpeg":"AAAA"})");
    browser = std::thread([&passed, url = server.url()] { passed = test::passesInBrowser("live.mjs", url); });
    for (int i = 0; i < 6000 && !server.isWatched(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    server.send("end", "{}");
  }
  browser.join();
  EXPECT_TRUE(passed);
}

}  // namespace
}  // namespace lodeline
