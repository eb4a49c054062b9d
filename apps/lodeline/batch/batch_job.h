#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "apps/lodeline/batch/batch_folder.h"
#include "apps/lodeline/batch/batch_list.h"
#include "apps/lodeline/batch/item_claim.h"

namespace lodeline {

/// One item at work: first the simulation of its recording where that is missing, then its run, in child
/// processes.
class BatchJob {
 public:
  /// Claims the item and starts a child. Empty where another process holds the item or its recording, or
  /// where `is_needed`, asked after the claim, says that it has finished it.
  static std::unique_ptr<BatchJob> start(const BatchList& list, const BatchFolder& folder,
                                         const BatchItem& item, const std::string& key, double stale_after_s,
                                         const std::function<bool()>& is_needed);

  /// Goes on where the child has ended. Returns the state of the item when it is finished.
  std::optional<ItemState> proceed();
  /// Renews the locks.
  void renew() const;
  pid_t child() const { return child_; }
  const BatchItem& item() const { return *item_; }
  /// Removes the unfinished files; the child must have ended.
  void discard() const;

 private:
  using Clock = std::chrono::steady_clock;

  BatchJob(const BatchList& list, const BatchFolder& folder, const BatchItem& item, std::string key);
  void startSimulation();
  void startRun();
  std::filesystem::path ownWork(const std::string& name) const;
  ItemState finishRun(int exit_code);
  ItemState fail(int exit_code, const std::string& stage, const std::string& message);
  nlohmann::ordered_json description(int exit_code) const;

  const BatchList* list_;
  const BatchFolder* folder_;
  const BatchItem* item_;
  std::string key_;
  std::unique_ptr<ItemClaim> claim_;
  std::unique_ptr<ItemClaim> recording_claim_;  ///< while the recording is simulated
  pid_t child_ = -1;
  Clock::time_point started_;
};

}  // namespace lodeline
