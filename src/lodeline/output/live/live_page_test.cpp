#include "lodeline/live.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include "lodeline/output/report/page/page_template.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

using testing::HasSubstr;

TEST(LivePage, ShowsTheOdometry) {
  if (pageTemplate().empty()) GTEST_SKIP() << "built without the page";
  Diagnostics diagnostics;
  OdometrySettings settings;
  settings.set("source.duration_s", "0.3");
  const auto source = openEuroc(testSourceDir() / "samples/cave_dive", settings.recording(), &diagnostics);
  Odometry odometry(source.get(), settings, &diagnostics);
  LivePage page(source->rig(), {.name = "a dive", .data = "samples"});
  while (const auto estimate = odometry.next()) page.show(odometry, *estimate, odometry.takeLandmarks());

  std::string url = page.url();
  url.pop_back();
  httplib::Client browser(url);
  const auto answer = browser.Get("/");
  ASSERT_TRUE(answer);
  EXPECT_THAT(answer->body, HasSubstr("a dive"));
  std::string events;
  browser.Get("/events", [&](const char* data, size_t size) {
    events.append(data, size);
    return events.find("\"status\"") == std::string::npos;  // until the state that was kept
  });
  EXPECT_THAT(events, HasSubstr("event: state"));
}

TEST(LivePage, RefusesARigWithoutCamera) { EXPECT_THROW(LivePage(Rig(), {}), InputError); }

}  // namespace
}  // namespace lodeline
