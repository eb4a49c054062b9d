#include "lodeline/data/image_loader.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>

namespace lodeline {

LoadedImage loadGreyImage(const std::filesystem::path& file) {
  LoadedImage result;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    result.problem = fmt::format("{}: image missing", file.string());
    return result;
  }
  try {
    result.image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    result.problem = fmt::format("{}: image damaged ({})", file.string(), error.what());
    return result;
  }
  if (result.image.empty()) result.problem = fmt::format("{}: image damaged or empty", file.string());
  return result;
}

}  // namespace lodeline
