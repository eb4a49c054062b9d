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

/// The images of one camera folder (camN): those that its data.csv lists, in the order of the file. Without
/// data.csv the list is made from the image files in camN/data, in order of time: where their names are
/// stamps (an integer as data.csv would have it, or seconds with decimals), these; else the rows of a times
/// file (timestamps.txt, times.txt) in the folder, beside it or above it, if it has one row an image.
class ImageList {
 public:
  /// Throws InputError where there is no list and none can be made. `diagnostics` must outlive the list.
  ImageList(const std::filesystem::path& camera, Diagnostics* diagnostics);

  /// The next image; nothing at the end.
  std::optional<ListedImage> next();

  /// Whether there is data.csv, or image files from which a list may be made.
  static bool hasImages(const std::filesystem::path& camera);
  /// The file that was read for the stamps, or the folder whose names were.
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
