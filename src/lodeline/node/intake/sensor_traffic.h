#pragma once

#include <cstdint>
#include <string>

namespace lodeline {

/// Messages of a sensor's topic, for diagnostics.
struct SensorTraffic {
  std::string sensor, topic;
  uint64_t received = 0;
  uint64_t lost = 0;      ///< sent, but not received, or received and not kept for want of room
  uint64_t unusable = 0;  ///< of a wrong type, cut off, or with numbers that are not finite
  std::string problem;    ///< why the last unusable message was of no use; empty where all were
};

}  // namespace lodeline
