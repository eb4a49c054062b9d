#include "apps/lodeline_dds/transport/dds_topics.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "apps/lodeline_dds/transport/dds_names.h"

namespace lodeline::dds {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPause{1};

int64_t sinceEpoch_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Topics::Topics(const NetworkOptions& options, const std::string& name_space, RosSession* session)
    : session_(session), network_(options, [this](const std::string& topic, const std::string& type) {
        const std::lock_guard lock(mutex_);
        found_.emplace_back(topic, type);
        changed_.notify_all();
      }) {
  for (const RosSession::Subscription& subscription : session->subscriptions()) {
    names_.push_back(fullName(subscription.topic, "/"));
  }
  for (const RosSession::Publication& topic : session->publications()) {
    network_.advertise(fullName(topic.topic, name_space), topic.type, {true, topic.depth, topic.is_latched});
  }
  worker_ = std::thread([this] { work(); });
}

Topics::~Topics() { close(); }

void Topics::close() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    changed_.notify_all();
  }
  if (worker_.joinable()) worker_.join();
  network_.close();
}

void Topics::publish(size_t publication, RosSession::Bytes message) {
  network_.publish(publication, std::move(message));
}

void Topics::work() {
  Clock::time_point next = Clock::now() + kPause;
  std::unique_lock lock(mutex_);
  while (!over_) {
    changed_.wait_until(lock, next, [this] { return over_ || !found_.empty(); });
    const std::vector<Found> found = std::exchange(found_, {});
    lock.unlock();
    for (const Found& one : found) subscribe(one);
    if (Clock::now() >= next) {
      session_->publishDiagnostics(sinceEpoch_ns(), [this](size_t publication, RosSession::Bytes message) {
        publish(publication, std::move(message));
      });
      next = Clock::now() + kPause;
    }
    lock.lock();
  }
}

void Topics::subscribe(const Found& found) {
  const auto& [dds_topic, dds_type] = found;
  if (!seen_.insert(found).second) return;
  for (size_t i = 0; i < names_.size(); ++i) {
    if (ddsTopic(names_[i]) != dds_topic || subscribed_.contains(i)) continue;
    const RosSession::Subscription& wanted = session_->subscriptions()[i];
    const std::string type = rosType(dds_type).value_or(dds_type);
    if (std::find(wanted.types.begin(), wanted.types.end(), type) == wanted.types.end()) {
      session_->addProblem(i, fmt::format("is of type {}, which {} does not have", type, wanted.sensor));
      continue;
    }
    subscribed_.insert(i);
    network_.subscribe(names_[i], type, {wanted.is_reliable, wanted.depth, false},
                       [session = session_, i, type](std::vector<uint8_t> cdr, uint64_t lost) {
                         if (lost > 0) session->addLost(i, lost);
                         session->receive(i, type, std::move(cdr));
                       });
  }
}

}  // namespace lodeline::dds
