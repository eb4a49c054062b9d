#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/io/rosbag/definitions/message_fields.h"
#include "lodeline/recording.h"
#include "lodeline/rig.h"

/// Functions that convert ROS 1 messages of a rig's sensors (packages sensor_msgs 1.13, geometry_msgs 1.13)
/// to readings and back. Parsing functions throw wire::Reader::CutOff where bytes are missing.
namespace lodeline::messages {

inline constexpr Type kImu = {"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2"};
inline constexpr Type kMagneticField = {"sensor_msgs/MagneticField", "2f3b0b43eed0c9501de0fa3ff89a45aa"};
inline constexpr Type kFluidPressure = {"sensor_msgs/FluidPressure", "804dc5cea1c5306d6a2eb80b9833befe"};
inline constexpr Type kRange = {"sensor_msgs/Range", "c005c34273dc426c67a020a87bc24148"};
inline constexpr Type kLaserScan = {"sensor_msgs/LaserScan", "90c7ef2dc6895d81024acba2ac42f369"};
inline constexpr Type kImage = {"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743"};
inline constexpr Type kCompressedImage = {"sensor_msgs/CompressedImage", "8f7a12909da2c9d3332d540a0977563f"};
/// Like CompressedImage, for a film; the order of its fields is another one.
inline constexpr Type kCompressedVideo = {"foxglove_msgs/CompressedVideo",
                                          "c5ea945275bc0729ed72f42e057a67bd"};
inline constexpr Type kPoseStamped = {"geometry_msgs/PoseStamped", "d3812c3cbc69362b77dc0b19b345f8f5"};

inline constexpr Type kOdometry = {"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7"};
inline constexpr Type kVector3Stamped = {"geometry_msgs/Vector3Stamped", "7b324c7325e683bf02a9b14b01090ec7"};

/// Types that a sensor may publish: imu0, mag0, pressure0, …; any other name is a camera.
std::vector<Type> typesOf(const std::string& sensor);
/// Types that a sensor may publish on a topic that the user names. They include types of several meanings:
/// Vector3Stamped as a field in tesla, Odometry as a depth, Twist as the velocity of a DVL, and JointState as
/// currents.
std::vector<Type> namedTypesOf(const std::string& sensor);

/// The stamp in the header with which each of these messages begins.
Time stampOf(std::span<const uint8_t> message);

ImuSample parseImu(std::span<const uint8_t> message);
/// Also parses a Vector3Stamped, which has the same first fields.
MagnetometerSample parseMagneticField(std::span<const uint8_t> message);
DepthSample parseFluidPressure(std::span<const uint8_t> message, const WaterColumn& water);
/// The depth below the origin of the world, whose z axis points up.
DepthSample parseOdometryDepth(std::span<const uint8_t> message);
/// One echo straight ahead (angle 0); none where the range is not a number within the sensor's limits.
std::vector<SonarSample> parseRange(std::span<const uint8_t> message);
/// The echo of a Range; none where it is not a number within the sensor's limits.
std::vector<AltimeterSample> parseAltimeter(std::span<const uint8_t> message);
/// The echoes of a scan, with stamps and angles computed from their positions in the scan.
std::vector<SonarSample> parseLaserScan(std::span<const uint8_t> message);

/// A stamped pose.
struct StampedPosition {
  Time time;
  Rigid3 world_from_body;
};
StampedPosition parsePoseStamped(std::span<const uint8_t> message);
/// The pose of an Odometry, without covariance and velocity.
StampedPosition parseOdometryPose(std::span<const uint8_t> message);

wire::Bytes imu(const ImuSample& sample, uint32_t sequence);
wire::Bytes magneticField(const MagnetometerSample& sample, uint32_t sequence);
wire::Bytes fluidPressure(const DepthSample& sample, const WaterColumn& water, uint32_t sequence);
/// A LaserScan with a single beam. Ranges and angles have 32 bits in ROS.
wire::Bytes laserScan(const SonarSample& sample, uint32_t sequence);
/// A Range, which has 32 bits.
wire::Bytes altimeterRange(const AltimeterSample& sample, uint32_t sequence);
wire::Bytes poseStamped(const StampedPosition& pose, uint32_t sequence);

}  // namespace lodeline::messages
