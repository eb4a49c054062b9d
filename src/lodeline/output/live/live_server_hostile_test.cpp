#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "lodeline/output/live/live_server.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A connection for requests that no HTTP library would send.
class RawClient {
 public:
  explicit RawClient(const LiveServer& server) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const std::string url = server.url();
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
    inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  }
  ~RawClient() { close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }

  /// All data until the server closes the connection.
  std::string answer() const {
    std::string text;
    char piece[65536];
    for (ssize_t size = 1; size > 0;) {
      size = recv(socket_, piece, sizeof(piece), 0);
      if (size > 0) text.append(piece, static_cast<size_t>(size));
    }
    return text;
  }

 private:
  int socket_;
};

std::string answerTo(const LiveServer& server, const std::string& headers, const std::string& path = "/") {
  const RawClient client(server);
  EXPECT_TRUE(client.send("GET " + path + " HTTP/1.1\r\nConnection: close\r\n" + headers + "\r\n"));
  return client.answer();
}

TEST(LiveServerHostile, ManyRangesGiveThePageOnce) {
  const std::string page(1'000'000, 'x');
  const LiveServer server("127.0.0.1", 0, page);
  std::string ranges = "0-999999";
  for (int i = 0; i < 499; ++i) ranges += ",0-999999";
  const std::string answer = answerTo(server, "Host: localhost\r\nRange: bytes=" + ranges + "\r\n");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 200"));
  EXPECT_LT(answer.size(), page.size() + 10'000);
  EXPECT_EQ(
      std::count(answer.begin() + static_cast<std::ptrdiff_t>(answer.find("\r\n\r\n")), answer.end(), 'x'),
      1'000'000);
}

TEST(LiveServerHostile, NamesOfOtherSitesAreRefused) {
  const LiveServer server("127.0.0.1", 0, "<p>secret</p>");
  for (const char* path : {"/", "/events"}) {
    const std::string answer = answerTo(server, "Host: evil.example\r\n", path);
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 403"));
    EXPECT_THAT(answer, Not(HasSubstr("secret")));
  }
  EXPECT_THAT(answerTo(server, "Host: 127.0.0.1:1\r\nOrigin: http://evil.example\r\n"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answerTo(server, ""), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(answerTo(server, "Host: localhost:9\r\nOrigin: http://localhost:9\r\n"), HasSubstr("secret"));
}

TEST(LiveServerHostile, AnswersSayWhatThePageMayLoad) {
  const LiveServer server("127.0.0.1", 0, "");
  EXPECT_THAT(answerTo(server, "Host: localhost\r\n"),
              HasSubstr("Content-Security-Policy: default-src 'none'"));
}

TEST(LiveServerHostile, HalfRequestsHoldUpNeitherThePageNorTheEnd) {
  auto server = std::make_unique<LiveServer>("127.0.0.1", 0, "<p>hello</p>");
  std::vector<std::unique_ptr<RawClient>> slow;
  for (int i = 0; i < 10; ++i) {
    slow.push_back(std::make_unique<RawClient>(*server));
    ASSERT_TRUE(slow.back()->send("GET / HTTP/1.1\r\n"));
  }
  std::atomic<bool> ended = false;
  // Sends one more byte before each read times out.
  std::thread dripping([&] {
    while (!ended) {
      for (const auto& client : slow) client->send("a");
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  });
  EXPECT_THAT(answerTo(*server, "Host: localhost\r\n"), HasSubstr("hello"));
  const auto start = std::chrono::steady_clock::now();
  server.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  ended = true;
  dripping.join();
}

}  // namespace
}  // namespace lodeline
