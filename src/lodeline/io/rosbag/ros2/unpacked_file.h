#pragma once

#include <filesystem>

namespace lodeline {

/// A file to read, unpacked where it is compressed with zstd as a whole, as ROS 2 does with
/// `compression_mode: FILE`. The unpacked copy is in the folder for temporary files (TMPDIR) and is removed
/// with the object.
class UnpackedFile {
 public:
  /// Throws InputError where the file is damaged or the copy cannot be written. Where the file ends too
  /// early, the copy has the part before, and `isCutOff()` holds.
  explicit UnpackedFile(const std::filesystem::path& file);
  ~UnpackedFile();
  UnpackedFile(UnpackedFile&& other) noexcept;
  UnpackedFile& operator=(UnpackedFile&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  bool isCutOff() const { return is_cut_off_; }

 private:
  void unpack(const std::filesystem::path& file);

  std::filesystem::path path_;
  bool is_copy_ = false;
  bool is_cut_off_ = false;
};

}  // namespace lodeline
