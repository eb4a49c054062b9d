#include "lodeline/mapping/session/mapping_thread.h"

#include <utility>

namespace lodeline {

MappingThread::MappingThread(Process process) : process_(std::move(process)), thread_([this] { work(); }) {}

MappingThread::~MappingThread() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  thread_.join();
}

void MappingThread::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    MapKeyframe keyframe = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    MappingStep step;
    std::exception_ptr error;
    try {
      step = process_(std::move(keyframe));
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    done_.push_back(std::move(step));
    if (error && !error_) error_ = error;
    changed_.notify_all();
  }
}

MappingStep MappingThread::takeOldest(std::unique_lock<std::mutex>& lock) {
  changed_.wait(lock, [this] { return !done_.empty(); });
  if (error_) std::rethrow_exception(error_);
  MappingStep step = std::move(done_.front());
  done_.pop_front();
  --open_;
  return step;
}

std::optional<MappingStep> MappingThread::add(MapKeyframe keyframe) {
  std::unique_lock lock(mutex_);
  waiting_.push_back(std::move(keyframe));
  ++open_;
  changed_.notify_all();
  if (open_ <= kDelay) return std::nullopt;
  return takeOldest(lock);
}

std::vector<MappingStep> MappingThread::finish() {
  std::unique_lock lock(mutex_);
  std::vector<MappingStep> steps;
  while (open_ > 0) steps.push_back(takeOldest(lock));
  return steps;
}

}  // namespace lodeline
