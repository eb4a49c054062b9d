#pragma once

#include <sys/resource.h>

namespace lodeline {

/// Processor time and memory of this process so far.
struct ProcessUsage {
  double processor_s = 0.0;  ///< user and system, all threads
  double peak_memory_MB = 0.0;

  static ProcessUsage now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
      return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    // Linux counts ru_maxrss in KiB.
    return {seconds(usage.ru_utime) + seconds(usage.ru_stime),
            1024e-6 * static_cast<double>(usage.ru_maxrss)};
  }
};

}  // namespace lodeline
