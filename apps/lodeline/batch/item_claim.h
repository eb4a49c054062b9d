#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lodeline {

/// The right of this process to make one item, held as a lock file. Files are numbered: a stale lock stays,
/// and the next number takes the item over. Only one process can create each number (O_EXCL), and a claim
/// holds only while no other live lock exists.
class ItemClaim {
 public:
  /// Claims the item whose locks are in `folder`. Empty where another live process holds it. A lock is stale
  /// where its process on this machine has ended, or where a process elsewhere has not renewed it for
  /// `stale_after_s`. Throws InputError where the folder cannot be written.
  static std::unique_ptr<ItemClaim> take(const std::filesystem::path& folder, double stale_after_s);
  ~ItemClaim();
  ItemClaim(const ItemClaim&) = delete;
  ItemClaim& operator=(const ItemClaim&) = delete;

  /// Renews the time of the lock file.
  void renew() const;

 private:
  ItemClaim(std::filesystem::path folder, int number, std::vector<int> stale);

  std::filesystem::path folder_;
  int number_;
  std::vector<int> stale_;  ///< locks that were stale when this one took over
};

/// HOST.PID of this process, for names of files.
std::string processLabel();

/// Time (s) of the file system of `folder`, which may differ from this machine's.
double fileSystemTime_s(const std::filesystem::path& folder);

/// Time (s) of the last change of a file; 0 where it does not exist.
double changeTime_s(const std::filesystem::path& file);

}  // namespace lodeline
