#pragma once

#include <string>

#include "lodeline/io/video/video_source.h"

namespace lodeline {

/// What a film and its telemetry hold, as the container states it: files, images, and all streams of readings
/// with counts, rates and times. Takes the source's sensors as they were opened; reads no image.
std::string videoText(const VideoSource& source);

}  // namespace lodeline
