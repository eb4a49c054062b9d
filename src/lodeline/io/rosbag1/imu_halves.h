#pragma once

#include <functional>
#include <optional>

#include "lodeline/io/rosbag1/bag_file.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// What the messages of an Imu topic hold. Drivers of RealSense cameras publish gyroscope and accelerometer
/// apart, each with zeros for the other.
struct ImuContent {
  bool has_gyroscope = false;
  bool has_accelerometer = false;

  bool isWhole() const { return has_gyroscope && has_accelerometer; }
};

/// Looks through a topic until both are seen to be other than zero; a whole IMU takes a few messages.
ImuContent contentOf(const BagTopic& topic, BagFile* bag);

/// Unites the halves of an IMU: one reading for each of the gyroscope's, with the specific force interpolated
/// linearly between the accelerometer's readings before and after. The gyroscope's readings before the first
/// of the accelerometer, after its last one, and in its gaps (more than four of its usual steps) are left
/// out.
class ImuHalves {
 public:
  using Next = std::function<std::optional<ImuSample>()>;

  /// The next united reading, from the next ones of either half.
  std::optional<ImuSample> next(const Next& gyroscope, const Next& accelerometer);

 private:
  bool advance(const Next& accelerometer);

  std::optional<ImuSample> before_, after_;  ///< of the accelerometer
  std::optional<Duration> usual_step_;       ///< shortest seen so far
};

}  // namespace lodeline
