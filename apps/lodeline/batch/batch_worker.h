#pragma once

#include <filesystem>

#include "apps/lodeline/batch/batch_folder.h"
#include "apps/lodeline/batch/batch_list.h"

namespace lodeline {

/// How one process works on a batch.
struct BatchWork {
  BatchShard shard;
  int jobs = 1;                  ///< runs at a time
  bool retry = false;            ///< run again what failed before this process started
  bool wait = true;              ///< wait for items of other processes, and take over those that die
  bool quiet = false;            ///< no progress
  double stale_after_s = 600.0;  ///< age of a lock from another machine that counts as dead
};

/// Number of items by their state.
struct BatchCounts {
  int made = 0;       ///< by this process, with success
  int kept = 0;       ///< results that existed
  int failed = 0;     ///< now or before
  int elsewhere = 0;  ///< left to other processes
};

/// Makes the items of a shard that have no result yet. Throws Interruption where the user stops it, after the
/// children have ended and the locks are released.
BatchCounts workOnBatch(const BatchList& list, const BatchFolder& folder, const BatchWork& work);

}  // namespace lodeline
