#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/output/foxglove/foxglove_schemas.h"
#include "lodeline/trajectory.h"

/// Messages of Foxglove's well-known schemas as JSON.
namespace lodeline::foxglove {

/// Levels of foxglove.Log.
enum class Level { Info = 2, Warning = 3, Error = 4 };

Json timeJson(Time time);

Json transformMessage(Time time, const std::string& parent, const std::string& child,
                      const Rigid3& parent_from_child);
Json poseMessage(const StampedPose& pose, const std::string& frame);
/// All poses of a path in one message, with one time.
Json pathMessage(Time time, const std::vector<StampedPose>& poses, const std::string& frame);
/// Points with the fields x, y, z (float, m) and observations (32 bits), 16 bytes each.
Json landmarksMessage(Time time, const std::vector<MapLandmark>& landmarks, const std::string& frame);
Json logMessage(Time time, Level level, const std::string& name, const std::string& text);
Json imageMessage(Time time, std::span<const uint8_t> jpeg, const std::string& frame);

}  // namespace lodeline::foxglove
