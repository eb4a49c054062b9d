#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/rig.h"

namespace lodeline {

/// What a recording holds of one sensor, for `lodeline inspect`.
struct VideoStreamFacts {
  std::string device;
  std::string key;  ///< e.g. "ACCL", or the name of a table
  std::string name;
  std::string unit;
  size_t samples = 0;
  size_t packets = 0;              ///< payloads; 0 for tables
  std::optional<int64_t> counted;  ///< by the camera (TSMP)
  double rate_hz = 0.0;
  double first_s = 0.0, last_s = 0.0;  ///< on the clock of the images
  std::string axes;                    ///< what stated them
};

/// Readings that accompany a film, on the clock of its images.
class VideoSensors {
 public:
  virtual ~VideoSensors() = default;
  virtual bool hasImu() const = 0;
  virtual bool hasMagnetometer() const = 0;
  virtual std::optional<ImuSample> nextImu() = 0;
  virtual std::optional<MagnetometerSample> nextMagnetometer() = 0;
  /// The first stamps of a sensor, from which its rate is measured.
  virtual std::vector<Time> firstImuStamps() const = 0;
  virtual std::vector<Time> firstMagnetometerStamps() const = 0;
  virtual const std::vector<VideoStreamFacts>& facts() const = 0;
};

}  // namespace lodeline
