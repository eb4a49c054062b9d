#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "lodeline/mapping/session/dive_mapping.h"

namespace lodeline {

/// Processes keyframes one after the other on another thread. The result of a keyframe is handed out when the
/// keyframe that comes kDelay later is added, neither earlier nor later. The same keyframes therefore give
/// the same results at the same moments, however fast the threads are.
class MappingThread {
 public:
  static constexpr size_t kDelay = 2;
  using Process = std::function<MappingStep(MapKeyframe)>;

  explicit MappingThread(Process process);
  ~MappingThread();
  MappingThread(const MappingThread&) = delete;
  MappingThread& operator=(const MappingThread&) = delete;

  /// Waits until the result that is due is there. Rethrows what `process` threw.
  std::optional<MappingStep> add(MapKeyframe keyframe);
  /// Results of the remaining keyframes. Nothing may be added after it.
  std::vector<MappingStep> finish();

 private:
  void work();
  MappingStep takeOldest(std::unique_lock<std::mutex>& lock);

  Process process_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<MapKeyframe> waiting_;
  std::deque<MappingStep> done_;
  std::exception_ptr error_;
  size_t open_ = 0;  ///< keyframes whose result has not been handed out
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace lodeline
