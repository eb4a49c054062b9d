#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/types.h"

namespace lodeline {

/// Mid-exposure times of images by file name.
class ImageTimes {
 public:
  /// Times are read from the names themselves.
  ImageTimes() = default;

  /// Reads a file with lines `name time[s]`, or EuRoC's `time[ns],name`. Throws InputError with the line's
  /// number for any other content.
  explicit ImageTimes(const std::filesystem::path& path);

  /// The time of an image: from the file if one was given (by the whole name, then by its last path
  /// component), else from the name without folder and extension: whole nanoseconds of at least 17 digits, or
  /// seconds with a decimal point. Empty when there is none.
  std::optional<Time> find(const std::string& image_name) const;

 private:
  bool has_file_ = false;
  std::map<std::string, Time> time_by_name_;
};

/// The image times of a EuRoC camera, in the order of the file: `data.csv` or the folder that holds it.
std::vector<Time> readImageStamps(const std::filesystem::path& path);

}  // namespace lodeline
