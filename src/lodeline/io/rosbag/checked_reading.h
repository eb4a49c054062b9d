#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/io/rosbag/messages.h"
#include "lodeline/rig.h"

namespace lodeline::messages {

inline bool isFinite(const ImuSample& s) {
  return s.angular_velocity_B.allFinite() && s.specific_force_B.allFinite();
}
inline bool isFinite(const MagnetometerSample& s) { return s.field_M.allFinite(); }
inline bool isFinite(const StampedPosition& s) {
  return s.world_from_body.translation.allFinite() && s.world_from_body.rotation.coeffs().allFinite();
}
inline bool isFinite(Time) { return true; }
inline bool isFinite(const DepthSample& s) { return std::isfinite(s.depth_m); }
inline bool isFinite(const std::vector<SonarSample>&) { return true; }  // parsing drops invalid echoes
inline bool isFinite(const std::vector<AltimeterSample>&) { return true; }

/// Parses a message with `parse`, one of the functions of messages.h. Returns nothing where the message
/// cannot be used; `problem` then gives the reason.
template <typename Parse>
auto checkedReading(std::span<const uint8_t> message, const Parse& parse, std::string* problem)
    -> std::optional<decltype(parse(message))> {
  try {
    auto reading = parse(message);
    if (isFinite(reading)) return reading;
    *problem = "holds no finite number where one is due";
  } catch (const wire::Reader::CutOff& error) {
    *problem = error.what();
  }
  return std::nullopt;
}

}  // namespace lodeline::messages
