#include "apps/lodeline/batch/batch_worker.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <fstream>
#include <memory>
#include <thread>
#include <vector>

#include "apps/lodeline/batch/batch_job.h"
#include "apps/lodeline/batch/child_process.h"
#include "apps/lodeline/batch/item_claim.h"
#include "apps/lodeline/shared/interruption.h"
#include "lodeline/pipeline/stop_request.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

using WorkerClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollInterval(20);
constexpr std::chrono::seconds kRescanInterval(1);
constexpr std::chrono::seconds kRenewInterval(30);

class BatchWorker {
 public:
  BatchWorker(const BatchList& list, const BatchFolder& folder, const BatchWork& work)
      : list_(list), folder_(folder), work_(work), progress_("batch", work.quiet) {
    createOutputFolder(folder.path());
    if (work.retry) started_s_ = fileSystemTime_s(folder.path());
    for (size_t i = 0; i < list.items.size(); ++i) {
      if (work.shard.contains(i)) open_.push_back({&list.items[i], keyOfItem(list.items[i], list)});
    }
    total_ = open_.size();
  }

  ~BatchWorker() { endJobs(); }
  BatchWorker(const BatchWorker&) = delete;
  BatchWorker& operator=(const BatchWorker&) = delete;

  BatchCounts run() {
    while (true) {
      if (stop_.made()) {
        endJobs();
        throw Interruption(fmt::format("{} of {} items are finished; the same command goes on from there",
                                       finished_, total_));
      }
      proceedJobs();
      startJobs();
      progress_.show(total_ == 0 ? 1.0 : static_cast<double>(finished_) / static_cast<double>(total_),
                     fmt::format("{} running", jobs_.size()));
      if (jobs_.empty() && (open_.empty() || (!work_.wait && was_scanned_))) break;
      std::this_thread::sleep_for(kPollInterval);
    }
    counts_.elsewhere = static_cast<int>(open_.size());
    return counts_;
  }

 private:
  struct OpenItem {
    const BatchItem* item;
    std::string key;
  };

  void proceedJobs() {
    const bool renews = WorkerClock::now() - renewed_ > kRenewInterval;
    if (renews) renewed_ = WorkerClock::now();
    for (std::unique_ptr<BatchJob>& job : jobs_) {
      if (renews) job->renew();
      const std::optional<ItemState> state = job->proceed();
      if (!state) continue;
      (*state == ItemState::Done ? counts_.made : counts_.failed) += 1;
      report(*state == ItemState::Done ? "done" : "failed", job->item());
      job.reset();
      next_scan_ = WorkerClock::now();
    }
    std::erase(jobs_, nullptr);
  }

  /// Starts items until all jobs are busy, or until each open item was looked at.
  void startJobs() {
    if (WorkerClock::now() < next_scan_) return;
    const size_t looked_at = open_.size();
    for (size_t i = 0; i < looked_at && jobs_.size() < static_cast<size_t>(work_.jobs); ++i) {
      if (stop_.made()) return;
      OpenItem open = std::move(open_.front());
      open_.pop_front();
      if (!isNeeded(open)) {
        count(open);
        continue;
      }
      auto job = BatchJob::start(list_, folder_, *open.item, open.key, work_.stale_after_s,
                                 [&] { return isNeeded(open); });
      if (job) {
        report("started", *open.item);
        jobs_.push_back(std::move(job));
      } else {
        open_.push_back(std::move(open));
      }
    }
    was_scanned_ = true;
    if (jobs_.size() < static_cast<size_t>(work_.jobs)) next_scan_ = WorkerClock::now() + kRescanInterval;
  }

  /// Whether the item has neither a result nor a failure that is to stay.
  bool isNeeded(const OpenItem& open) const {
    const ItemState state = folder_.state(*open.item, open.key);
    if (state != ItemState::Failed) return state == ItemState::Open;
    return work_.retry && changeTime_s(folder_.failure(*open.item) / "item.json") < started_s_;
  }

  /// Counts an item that needs no work.
  void count(const OpenItem& open) {
    if (folder_.state(*open.item, open.key) == ItemState::Failed) {
      ++counts_.failed;
      report("failed before", *open.item);
    } else {
      ++counts_.kept;
      ++finished_;
    }
    tidy(*open.item);
  }

  /// Removes what a process left that was killed between its last result and the release of its lock.
  void tidy(const BatchItem& item) const {
    std::error_code ignored;
    if (!std::filesystem::exists(folder_.lock(item.name), ignored)) return;
    const auto claim = ItemClaim::take(folder_.lock(item.name), work_.stale_after_s);
    if (claim) std::filesystem::remove_all(folder_.work(item.name), ignored);
  }

  /// Records what this process did, for the user and in workers/HOST.PID.csv.
  void report(const char* event, const BatchItem& item) {
    const double now_s =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    if (!record_.is_open()) {
      const std::filesystem::path workers = folder_.path() / "workers";
      createOutputFolder(workers);
      record_.open(workers / (processLabel() + ".csv"), std::ios::app);
    }
    record_ << fmt::format("{:.3f},{},{}\n", now_s, item.name, event) << std::flush;
    if (std::string_view(event) != "started") ++finished_;
    progress_.end();
    if (!work_.quiet) fmt::print(stderr, "{} of {}: {} {}\n", finished_, total_, item.name, event);
  }

  void endJobs() {
    std::vector<pid_t> children;
    for (const auto& job : jobs_) children.push_back(job->child());
    endChildren(children);
    for (const auto& job : jobs_) job->discard();
    jobs_.clear();
  }

  const BatchList& list_;
  const BatchFolder& folder_;
  const BatchWork& work_;
  Progress progress_;
  StopRequest stop_;
  std::ofstream record_;
  double started_s_ = 0.0;  ///< on the clock of the file system
  std::deque<OpenItem> open_;
  std::vector<std::unique_ptr<BatchJob>> jobs_;
  BatchCounts counts_;
  size_t total_ = 0;
  size_t finished_ = 0;
  bool was_scanned_ = false;
  WorkerClock::time_point next_scan_ = WorkerClock::now();
  WorkerClock::time_point renewed_ = WorkerClock::now();
};

}  // namespace

BatchCounts workOnBatch(const BatchList& list, const BatchFolder& folder, const BatchWork& work) {
  return BatchWorker(list, folder, work).run();
}

}  // namespace lodeline
