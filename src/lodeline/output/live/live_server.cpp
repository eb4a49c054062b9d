#include "lodeline/output/live/live_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <sys/socket.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/live/event_queue.h"
#include "lodeline/output/live/request_guard.h"

namespace lodeline {
namespace {

constexpr size_t kQueueLength = 64;
constexpr size_t kMostKept = 4000;
/// A browser that does not read for this time counts as disconnected.
constexpr int kWriteTimeout_s = 2;
/// A request is dropped if its next byte does not arrive within this time.
constexpr int kReadTimeout_s = 2;
/// Maximum number of simultaneous connections. Incomplete requests occupy one each until they are dropped.
constexpr size_t kMostConnections = 32;
constexpr size_t kPieceBytes = 1 << 14;

/// Scripts and styles of the page are inline; it loads no resources and connects only to this server.
constexpr const char* kSecurityPolicy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string eventText(const std::string& event, const std::string& data) {
  return fmt::format("event: {}\ndata: {}\n\n", event, data);
}

/// Sets SO_REUSEADDR. With httplib's default, SO_REUSEPORT, a second program could share the port unnoticed.
void reuseAddress(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

/// Closes every connection of this process on `port`, so that a client which sends its request byte by byte
/// cannot delay the end. httplib does not expose its sockets.
void shutConnections(int port) {
  const int most = static_cast<int>(sysconf(_SC_OPEN_MAX));
  for (int file = 3; file < std::min(most, 4096); ++file) {
    sockaddr_storage own{}, peer{};
    socklen_t own_size = sizeof(own), peer_size = sizeof(peer);
    if (getsockname(file, reinterpret_cast<sockaddr*>(&own), &own_size) != 0) continue;
    if (getpeername(file, reinterpret_cast<sockaddr*>(&peer), &peer_size) != 0) continue;
    in_port_t own_port = 0;
    if (own.ss_family == AF_INET) own_port = reinterpret_cast<const sockaddr_in&>(own).sin_port;
    if (own.ss_family == AF_INET6) own_port = reinterpret_cast<const sockaddr_in6&>(own).sin6_port;
    if (own_port != 0 && ntohs(own_port) == port) shutdown(file, SHUT_RDWR);
  }
}

/// Answers 403 to requests that a browser would not send to this server deliberately.
httplib::Server::HandlerResponse refuseForeign(const std::string& bound_address,
                                               const httplib::Request& request, httplib::Response& response) {
  response.set_header("Content-Security-Policy", kSecurityPolicy);
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  const std::string host = request.get_header_value("Host");
  const std::string origin = request.get_header_value("Origin");
  const bool is_foreign = request.has_header("Origin") && origin != "http://" + host;
  if (isAddressOrLocalhost(host, bound_address) && !is_foreign) {
    return httplib::Server::HandlerResponse::Unhandled;
  }
  response.status = 403;
  response.set_content("this page answers at its address or at localhost only\n", "text/plain");
  return httplib::Server::HandlerResponse::Handled;
}

}  // namespace

struct LiveServer::State {
  std::string address;
  int port = 0;
  std::string page;
  httplib::Server server;
  std::thread thread;

  std::mutex mutex;
  std::condition_variable left;  ///< a watcher has
  std::vector<std::shared_ptr<EventQueue>> watchers;
  std::deque<std::string> kept;
  bool closed = false;

  std::shared_ptr<EventQueue> addWatcher();
  void removeWatcher(const std::shared_ptr<EventQueue>& queue);
  void tell(const std::string& text);
  void answerPage(httplib::Response& response);
  void answerEvents(httplib::Response& response);
};

/// Adds a browser whose queue starts with the kept events; null at the maximum number of browsers.
std::shared_ptr<EventQueue> LiveServer::State::addWatcher() {
  const std::lock_guard lock(mutex);
  if (closed || watchers.size() >= kMostWatchers) return nullptr;
  auto queue = std::make_shared<EventQueue>(kQueueLength);
  std::string history = "retry: 2000\n\n";
  for (const std::string& text : kept) history += text;
  queue->push(std::move(history));
  watchers.push_back(queue);
  return queue;
}

void LiveServer::State::removeWatcher(const std::shared_ptr<EventQueue>& queue) {
  {
    const std::lock_guard lock(mutex);
    std::erase(watchers, queue);
  }
  left.notify_all();
}

void LiveServer::State::tell(const std::string& text) {
  for (const auto& queue : watchers) queue->push(text);
}

/// Sends the whole page in pieces, whatever ranges the request names: httplib would copy it once per range.
void LiveServer::State::answerPage(httplib::Response& response) {
  response.status = 200;
  response.set_chunked_content_provider(
      "text/html; charset=utf-8", [this](size_t offset, httplib::DataSink& sink) {
        const size_t size = std::min(kPieceBytes, page.size() - std::min(page.size(), offset));
        if (size > 0) return sink.write(page.data() + offset, size);
        sink.done();
        return true;
      });
}

void LiveServer::State::answerEvents(httplib::Response& response) {
  std::shared_ptr<EventQueue> queue = addWatcher();
  if (!queue) {
    response.status = 503;
    response.set_content(fmt::format("{} browsers watch already\n", kMostWatchers), "text/plain");
    return;
  }
  response.status = 200;
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider(
      "text/event-stream",
      [queue](size_t /*offset*/, httplib::DataSink& sink) {
        const std::optional<std::string> text = queue->pop();
        if (text) return sink.write(text->data(), text->size());
        sink.done();
        return true;
      },
      [this, queue](bool /*success*/) { removeWatcher(queue); });
}

LiveServer::LiveServer(const std::string& address, int port, std::string page)
    : state_(std::make_unique<State>()) {
  state_->address = address;
  state_->page = std::move(page);
  httplib::Server& server = state_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(kMostConnections); };
  server.set_socket_options(&reuseAddress);
  server.set_write_timeout(kWriteTimeout_s);
  server.set_read_timeout(kReadTimeout_s);
  server.set_payload_max_length(0);
  server.set_pre_routing_handler([address](const httplib::Request& request, httplib::Response& response) {
    return refuseForeign(address, request, response);
  });
  server.set_keep_alive_timeout(1);
  server.Get("/", [state = state_.get()](const httplib::Request&, httplib::Response& response) {
    state->answerPage(response);
  });
  server.Get("/events", [state = state_.get()](const httplib::Request&, httplib::Response& response) {
    state->answerEvents(response);
  });
  state_->port =
      port == 0 ? server.bind_to_any_port(address) : (server.bind_to_port(address, port) ? port : -1);
  if (state_->port < 0) {
    throw UsageError(fmt::format(
        "--live {}: the port cannot be had on {}; another program may use it: choose another, or 0 for any",
        port, address));
  }
  state_->thread = std::thread([&server] { server.listen_after_bind(); });
}

LiveServer::~LiveServer() {
  {
    std::unique_lock lock(state_->mutex);
    state_->closed = true;
    for (const auto& queue : state_->watchers) queue->close();
    // A stopped server drops pending data.
    state_->left.wait_for(lock, std::chrono::seconds(kWriteTimeout_s),
                          [this] { return state_->watchers.empty(); });
  }
  // Stopping a server that does not run yet has no effect.
  while (!state_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  state_->server.stop();
  shutConnections(state_->port);
  state_->thread.join();
}

std::string LiveServer::url() const { return fmt::format("http://{}:{}/", state_->address, state_->port); }

bool LiveServer::isWatched() const {
  const std::lock_guard lock(state_->mutex);
  return !state_->watchers.empty();
}

void LiveServer::send(const std::string& event, const std::string& data) {
  const std::lock_guard lock(state_->mutex);
  state_->tell(eventText(event, data));
}

void LiveServer::sendAndKeep(const std::string& event, const std::string& data) {
  const std::lock_guard lock(state_->mutex);
  state_->kept.push_back(eventText(event, data));
  state_->tell(state_->kept.back());
  if (state_->kept.size() < kMostKept) return;
  std::deque<std::string> thinned;
  for (size_t i = 0; i < state_->kept.size(); i += 2) thinned.push_back(std::move(state_->kept[i]));
  state_->kept = std::move(thinned);
}

}  // namespace lodeline
