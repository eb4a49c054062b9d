#pragma once

#include <filesystem>

namespace lodeline {

/// Locks a results folder for one writer (flock) until destruction. Two programs that write the same files
/// would mix their results without an error. The system releases the lock if the program dies. On a file
/// system without locks, the folder stays unprotected.
class FolderLock {
 public:
  /// Throws InputError naming the folder where any program already holds the lock.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace lodeline
