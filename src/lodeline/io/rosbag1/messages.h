#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/rosbag1/wire.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/sensors/measurements.h"

/// The messages of ROS 1 that a rig's sensors publish (packages sensor_msgs 1.13, geometry_msgs 1.13), to and
/// from readings. Functions that parse throw wire::Reader::CutOff where the bytes are not all there.
namespace lodeline::messages {

/// The name of a message's type and the sum over its definition, which changes when the definition does.
struct Type {
  const char* name;
  const char* md5sum;
};

inline constexpr Type kImu = {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2"};
inline constexpr Type kMagneticField = {"sensor_msgs/MagneticField", "2f3b0b43eed0c9501de0fa3ff89a45aa"};
inline constexpr Type kFluidPressure = {"sensor_msgs/FluidPressure", "804dc5cea1c5306d6a2eb80b9833befe"};
inline constexpr Type kRange = {"sensor_msgs/Range", "c005c34273dc426c67a020a87bc24148"};
inline constexpr Type kLaserScan = {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"};
inline constexpr Type kImage = {"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743"};
inline constexpr Type kCompressedImage = {"sensor_msgs/CompressedImage", "8f7a12909da2c9d3332d540a0977563f"};
inline constexpr Type kPoseStamped = {"geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"};

/// Those that a sensor may publish: imu0, mag0, pressure0, sonar0; any other one is a camera.
std::vector<Type> typesOf(const std::string& sensor);

/// The stamp in the header that every one of these begins with.
Time stampOf(std::span<const uint8_t> message);

ImuSample parseImu(std::span<const uint8_t> message);
MagnetometerSample parseMagneticField(std::span<const uint8_t> message);
DepthSample parseFluidPressure(std::span<const uint8_t> message, const WaterColumn& water);
/// One echo, straight ahead (angle 0); none where the range is not a number within the sensor's limits.
std::vector<SonarSample> parseRange(std::span<const uint8_t> message);
/// The echoes of a scan, each with the stamp and angle that its place in the scan has.
std::vector<SonarSample> parseLaserScan(std::span<const uint8_t> message);

/// A pose with its stamp.
struct StampedPosition {
  Time time;
  Rigid3 world_from_body;
};
StampedPosition parsePoseStamped(std::span<const uint8_t> message);

wire::Bytes imu(const ImuSample& sample, uint32_t sequence);
wire::Bytes magneticField(const MagnetometerSample& sample, uint32_t sequence);
wire::Bytes fluidPressure(const DepthSample& sample, const WaterColumn& water, uint32_t sequence);
/// A scan of a single beam. Ranges and angles have 32 bits in ROS.
wire::Bytes laserScan(const SonarSample& sample, uint32_t sequence);
wire::Bytes poseStamped(const StampedPosition& pose, uint32_t sequence);

}  // namespace lodeline::messages
