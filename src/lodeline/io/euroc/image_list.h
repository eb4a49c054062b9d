#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/euroc/csv_reader.h"

namespace lodeline {

/// An image file with its stamp.
struct ListedImage {
  Time time;
  std::filesystem::path file;
};

/// The images of one camera folder (camN) in the order of its data.csv. Without data.csv, the list is made
/// from the image files in camN/data in order of time. File names that are stamps give the times (an integer
/// as in data.csv, or seconds with decimals). Otherwise a times file (timestamps.txt, times.txt) in the
/// folder, beside it or above it gives the times, if it has one row per image.
class ImageList {
 public:
  /// Throws InputError where there is no list and none can be made. `diagnostics` must outlive the list.
  ImageList(const std::filesystem::path& camera, Diagnostics* diagnostics);

  /// The next image; nothing at the end.
  std::optional<ListedImage> next();

  /// Share of the list that was returned, 0 to 1.
  std::optional<double> shareRead() const;

  /// Whether data.csv exists, or image files from which a list may be made.
  static bool hasImages(const std::filesystem::path& camera);
  /// The file with the stamps, or the folder whose file names are the stamps.
  const std::filesystem::path& origin() const { return origin_; }
  bool isMade() const { return !csv_; }

 private:
  void makeList(const std::filesystem::path& camera);

  std::filesystem::path folder_, origin_;
  std::optional<CsvReader> csv_;
  std::vector<ListedImage> made_;
  size_t next_ = 0;
  CsvRow row_;
};

}  // namespace lodeline
