#include <thread>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/output/live/live_server.h"
#include "lodeline/output/report/page/page_template.h"

// Included last, because its macros (<resolv.h>) conflict with Eigen.
#include <httplib.h>

// Tests of `lodeline run --live`.

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

class Live : public RoomTest {
 protected:
  void SetUp() override {
    if (pageTemplate().empty()) GTEST_SKIP() << "built without the report page";
  }
  /// A port that is free at this moment.
  static int freePort() {
    const LiveServer server("127.0.0.1", 0, "");
    const std::string url = server.url();
    return std::stoi(url.substr(url.rfind(':') + 1));
  }
};

constexpr const char* kResults[] = {"trajectory.tum", "states.csv", "landmarks.ply", "config.yaml"};

TEST_F(Live, ChangesNothingAndTellsABrowserEverything) {
  ASSERT_EQ(run("--no-report").exit_code, 0);
  const std::filesystem::path without = output_;
  output_ = folder_.path() / "live";
  const int port = freePort();
  std::string told;
  std::thread browser([port, &told] {
    httplib::Client client("127.0.0.1", port);
    // The program needs a moment until it accepts connections.
    for (int i = 0; i < 2000 && told.empty(); ++i) {
      client.Get("/events", [&told](const char* data, size_t size) {
        told.append(data, size);
        return true;
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  const Execution result = run(fmt::format("--no-report --live {}", port));
  browser.join();
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr(fmt::format("live at http://127.0.0.1:{}/", port)));
  for (const char* name : kResults) EXPECT_EQ(readText(output_ / name), readText(without / name)) << name;
  EXPECT_THAT(told, HasSubstr("event: state\ndata: {\"t_s\":"));
  EXPECT_THAT(told, HasSubstr("\"status\":\"tracking\""));
  EXPECT_THAT(told, HasSubstr("event: picture\ndata: {\"t_s\":"));
  EXPECT_THAT(told, HasSubstr("\"jpeg\":\"/9j/"));
  EXPECT_THAT(told, HasSubstr("event: end"));
}

TEST_F(Live, BrowserThatVanishesDoesNoHarm) {
  const int port = freePort();
  std::thread browser([port] {
    httplib::Client client("127.0.0.1", port);
    bool told = false;
    for (int i = 0; i < 2000 && !told; ++i) {
      client.Get("/events", [&told](const char*, size_t) {
        told = true;
        return false;
      });
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  const Execution result = run(fmt::format("--live {}", port));
  browser.join();
  expectGoodResult(result);
}

TEST_F(Live, TakesAnyPortForNoughtAndADefaultForNone) {
  EXPECT_THAT(run("--live 0").output, HasSubstr("live at http://127.0.0.1:"));
  EXPECT_EQ(run("--live 70000").exit_code, 2);
  EXPECT_EQ(run("--live=here").exit_code, 2);
}

TEST_F(Live, DoesNotTakeTheRecordingForAPort) {
  const std::string data = quoted(recording_.data);
  const std::string output = "-q --no-report --overwrite -o " + quoted(output_);
  // Any order of the arguments. Only the parsing is tested, because the default port may be in use.
  for (const std::string& command :
       {"run --live 0 " + data + " " + output, "run " + data + " " + output + " --live 0",
        "run --live=0 " + data + " " + output}) {
    EXPECT_EQ(runProgram(command).exit_code, 0) << command;
  }
  for (const std::string& command : {"run --live nowhere " + output, "run nowhere --live " + output,
                                     "run nowhere " + output + " --live"}) {
    const Execution result = runProgram(command);
    EXPECT_EQ(result.exit_code, 1) << command;
    EXPECT_THAT(result.output, HasSubstr("bad input: nowhere")) << command;
  }
  EXPECT_EQ(run("--live here").exit_code, 2);
}

TEST_F(Live, PortInUseIsSaidBeforeTheRunBegins) {
  const LiveServer other("127.0.0.1", 0, "");
  const std::string url = other.url();
  const Execution result = run("--live " + url.substr(url.rfind(':') + 1, url.size() - url.rfind(':') - 2));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("another program may use it"));
}

}  // namespace
}  // namespace lodeline::test
