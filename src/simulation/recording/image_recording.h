#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "lodeline/simulation.h"
#include "simulation/dive/dive.h"
#include "simulation/rendering/image_renderer.h"

namespace lodeline {

/// One image to render.
struct ScheduledImage {
  int camera = 0;
  double middle_s = 0.0;  ///< true middle of the exposure, relative to the motion's start
  Time stamp;             ///< stamp in the recording
};

/// All images of a dive sorted by time, then by camera, without dropped ones.
std::vector<ScheduledImage> scheduleImages(const Dive& dive);

/// Writes mav0/camN/data.csv for all cameras.
void recordImageLists(const Dive& dive, const std::vector<ScheduledImage>& images,
                      const std::filesystem::path& folder);

/// Renders mav0/camN/data/STAMP.png in parallel. Existing images are kept. Each image gets its name only when
/// complete, so an interrupted recording can be continued. Throws InputError where an image cannot be
/// written.
ImageProgress recordImages(const ImageRenderer& renderer, const Dive& dive,
                           const std::vector<ScheduledImage>& images, const std::filesystem::path& folder,
                           const ImageRecordingOptions& options);

}  // namespace lodeline
