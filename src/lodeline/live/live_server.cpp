#include "lodeline/live/live_server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "lodeline/base/error.h"
#include "lodeline/live/event_queue.h"

namespace lodeline {
namespace {

constexpr size_t kQueueLength = 64;
constexpr size_t kMostKept = 4000;
/// A browser that takes nothing for so long is taken for gone.
constexpr int kWriteTimeout_s = 2;

std::string eventText(const std::string& event, const std::string& data) {
  return fmt::format("event: {}\ndata: {}\n\n", event, data);
}

/// httplib's own choice, SO_REUSEPORT, would let a second program share the port without a word.
void reuseAddress(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
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
  void answerEvents(httplib::Response& response);
};

/// With what was kept as the first of its texts; nothing where there are enough watchers.
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

void LiveServer::State::answerEvents(httplib::Response& response) {
  std::shared_ptr<EventQueue> queue = addWatcher();
  if (!queue) {
    response.status = 503;
    response.set_content(fmt::format("{} browsers watch already\n", kMostWatchers), "text/plain");
    return;
  }
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
  // One thread a watcher and two for pages.
  server.new_task_queue = [] { return new httplib::ThreadPool(kMostWatchers + 2); };
  server.set_socket_options(&reuseAddress);
  server.set_write_timeout(kWriteTimeout_s);
  server.set_keep_alive_timeout(1);
  server.Get("/", [state = state_.get()](const httplib::Request&, httplib::Response& response) {
    response.set_content(state->page, "text/html; charset=utf-8");
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
    // A server that is stopped drops what is still to be sent.
    state_->left.wait_for(lock, std::chrono::seconds(kWriteTimeout_s),
                          [this] { return state_->watchers.empty(); });
  }
  // Stopping a server that does not run yet would be forgotten.
  while (!state_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  state_->server.stop();
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
