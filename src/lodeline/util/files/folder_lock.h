#pragma once

#include <filesystem>

namespace lodeline {

/// Keeps a folder of results for one writer: two programs that write the same files make one result of two,
/// and neither notices. Held until destroyed, and given back by the system if the program dies. A file system
/// without locks goes unguarded.
class FolderLock {
 public:
  /// Throws InputError naming the folder where another lock on it is held, by whatever program.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace lodeline
