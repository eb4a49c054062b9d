#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "simulation/dive/dive.h"
#include "simulation/rendering/image_renderer.h"

namespace lodeline {

/// One image to be made.
struct ScheduledImage {
  int camera = 0;
  double middle_s = 0.0;  ///< of the exposure, after the motion's start, true
  Time stamp;             ///< as the recording will say it
};

/// All images of a dive in order of time, then camera, those that were dropped left out.
std::vector<ScheduledImage> scheduleImages(const Dive& dive);

/// Writes mav0/camN/data.csv for all cameras.
void recordImageLists(const Dive& dive, const std::vector<ScheduledImage>& images,
                      const std::filesystem::path& folder);

struct ImageProgress {
  size_t done = 0;      ///< images in the folder
  size_t rendered = 0;  ///< of which made by this run
  size_t total = 0;
};

struct ImageRecordingOptions {
  int threads = 0;                                     ///< 0: as many as the machine has
  std::function<bool()> stop;                          ///< asked after each image
  std::function<void(const ImageProgress&)> progress;  ///< told after each image, one call at a time
};

/// Renders into mav0/camN/data/STAMP.png, in parallel. Images that are there already stay as they are; each
/// appears under its name only when complete, so an interrupted recording can be taken up again. Throws
/// InputError where an image cannot be written.
ImageProgress recordImages(const ImageRenderer& renderer, const Dive& dive,
                           const std::vector<ScheduledImage>& images, const std::filesystem::path& folder,
                           const ImageRecordingOptions& options);

}  // namespace lodeline
