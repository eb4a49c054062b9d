#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// JSON schemas of the messages, by the field definitions of Foxglove's well-known schemas
/// (docs.foxglove.dev/docs/sdk/schemas). Foxglove chooses the display of a message by the schema's name.
namespace lodeline::foxglove {

using Json = nlohmann::ordered_json;

inline constexpr const char* kTransform = "foxglove.FrameTransform";
inline constexpr const char* kPose = "foxglove.PoseInFrame";
inline constexpr const char* kPoses = "foxglove.PosesInFrame";
inline constexpr const char* kPointCloud = "foxglove.PointCloud";
inline constexpr const char* kLog = "foxglove.Log";
inline constexpr const char* kImage = "foxglove.CompressedImage";
/// Lodeline's own schema of one row of states.csv.
inline constexpr const char* kState = "lodeline.State";

/// The schema of one of Foxglove's names above.
Json schemaOf(const std::string& name);

/// The schema of states: a time, numbers and words. Only the time is in every message.
Json stateSchema(const std::vector<std::string>& numbers, const std::vector<std::string>& words);

}  // namespace lodeline::foxglove
