#include "lodeline/output/live/live_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using Clock = std::chrono::steady_clock;

httplib::Client clientOf(const LiveServer& server) {
  std::string url = server.url();
  url.pop_back();
  return httplib::Client(url);
}

void waitFor(const std::function<bool()>& condition) {
  const auto end = Clock::now() + std::chrono::seconds(20);
  while (!condition() && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ASSERT_TRUE(condition());
}

/// Receives events on its own thread until `enough` is true or the server ends.
class Watcher {
 public:
  explicit Watcher(const LiveServer& server, std::function<bool(const std::string&)> enough = nullptr)
      : client_(clientOf(server)), thread_([this, enough] {
          client_.Get("/events", [this, enough](const char* data, size_t size) {
            text_.append(data, size);
            return !enough || !enough(text_);
          });
        }) {
    waitFor([&server] { return server.isWatched(); });
  }
  ~Watcher() {
    if (thread_.joinable()) thread_.join();
  }
  std::string text() {
    thread_.join();
    return text_;
  }

 private:
  httplib::Client client_;
  std::string text_;
  std::thread thread_;
};

TEST(LiveServer, GivesThePage) {
  const LiveServer server("127.0.0.1", 0, "<p>hello</p>");
  const auto answer = clientOf(server).Get("/");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->body, "<p>hello</p>");
  EXPECT_FALSE(server.isWatched());
}

TEST(LiveServer, TellsWatchersEverythingUpToItsEnd) {
  auto server = std::make_unique<LiveServer>("127.0.0.1", 0, "");
  Watcher watcher(*server);
  server->send("pose", "{\"t_s\":1}");
  server->send("end", "{}");
  server.reset();
  const std::string text = watcher.text();
  EXPECT_THAT(text, HasSubstr("event: pose\ndata: {\"t_s\":1}\n\n"));
  EXPECT_THAT(text, HasSubstr("event: end\ndata: {}\n\n"));
}

TEST(LiveServer, TellsLatecomersWhatWasKept) {
  auto server = std::make_unique<LiveServer>("127.0.0.1", 0, "");
  server->sendAndKeep("pose", "1");
  server->send("picture", "gone");
  Watcher watcher(*server);
  server.reset();
  const std::string text = watcher.text();
  EXPECT_THAT(text, HasSubstr("event: pose\ndata: 1\n\n"));
  EXPECT_THAT(text, testing::Not(HasSubstr("gone")));
}

TEST(LiveServer, WhoeverVanishesIsForgotten) {
  LiveServer server("127.0.0.1", 0, "");
  {
    Watcher watcher(server, [](const std::string& text) { return text.find("first") != std::string::npos; });
    server.send("pose", "first");
  }
  // Sending into the closed connection shows that no one listens.
  waitFor([&server] {
    server.send("pose", "second");
    return !server.isWatched();
  });
}

TEST(LiveServer, WhoeverDoesNotListenHoldsNobodyUp) {
  LiveServer server("127.0.0.1", 0, "");
  std::atomic<bool> go_on = false;
  Watcher sleeper(server, [&go_on](const std::string&) {
    while (!go_on) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return true;
  });
  const std::string large(100'000, 'x');
  const auto start = Clock::now();
  for (int i = 0; i < 1000; ++i) server.send("picture", large);
  // 100 MB: more than any socket buffers, sent within the time of copying.
  EXPECT_LT(Clock::now() - start, std::chrono::milliseconds(1500));
  go_on = true;
}

TEST(LiveServer, SaysThatItIsFull) {
  LiveServer server("127.0.0.1", 0, "");
  std::vector<std::unique_ptr<Watcher>> watchers;
  const auto leave = [](const std::string& text) { return text.find("leave") != std::string::npos; };
  for (size_t i = 0; i < LiveServer::kMostWatchers; ++i) {
    watchers.push_back(std::make_unique<Watcher>(server, leave));
  }
  waitFor([&server] {
    const auto is_full = [](const httplib::Response& response) { return response.status == 503; };
    const auto answer = clientOf(server).Get("/events", is_full, [](const char*, size_t) { return true; });
    return answer && answer->status == 503;
  });
  server.send("pose", "leave");
}

TEST(LiveServer, PortInUseIsSaid) {
  const LiveServer server("127.0.0.1", 0, "");
  const std::string url = server.url();
  const int port = std::stoi(url.substr(url.rfind(':') + 1));
  try {
    const LiveServer second("127.0.0.1", port, "");
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr(std::to_string(port)));
    EXPECT_THAT(error.what(), HasSubstr("choose another"));
  }
}

}  // namespace
}  // namespace lodeline
