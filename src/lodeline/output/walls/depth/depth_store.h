#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "lodeline/output/walls/depth/depth_image.h"

namespace lodeline {

/// Writes a file under another name and then renames it, so that an interruption leaves no half of it.
/// Throws InputError naming the file.
void writeWhole(const std::filesystem::path& file, std::string_view bytes);

/// Depth images in a folder, packed without loss, so that memory does not grow with the dive.
class DepthStore {
 public:
  /// Creates the folder. Throws InputError where that fails.
  explicit DepthStore(std::filesystem::path folder);

  bool has(size_t number) const { return std::filesystem::exists(fileOf(number)); }
  void write(size_t number, const DepthImage& image) const;
  /// Throws InputError where the file is missing or damaged.
  DepthImage read(size_t number) const;

 private:
  std::filesystem::path fileOf(size_t number) const;

  std::filesystem::path folder_;
};

}  // namespace lodeline
