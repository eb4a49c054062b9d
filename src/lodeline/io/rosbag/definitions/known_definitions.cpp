#include "lodeline/io/rosbag/definitions/known_definitions.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "lodeline/io/rosbag/definitions/definition_parser.h"

namespace lodeline::definitions {
namespace {

struct Known {
  std::string_view type;
  std::string_view fields;
  std::string_view ros1_fields = {};  ///< where they differ
  std::string_view ros1_checksum = {};
  bool has_versions = false;  ///< whether definitions of other versions are in use
};

// Definitions of DVLs that two packages share.
constexpr std::string_view kA50Beam =
    "int64 id\nfloat64 velocity\nfloat64 distance\nfloat64 rssi\nfloat64 nsd\nbool valid\n";
constexpr std::string_view kSimulatedBeam =
    "float64 range\nfloat64 range_covariance\nfloat64 velocity\nfloat64 velocity_covariance\n"
    "geometry_msgs/PoseStamped pose\n";
constexpr std::string_view kSimulatedDvl =
    "std_msgs/Header header\ngeometry_msgs/Vector3 velocity\nfloat64[9] velocity_covariance\n"
    "float64 altitude\nDVLBeam[] beams\n";
constexpr std::string_view kSimulatedDvlChecksum = "02bba6182b6f271447d7f88473256572";

constexpr std::array kKnown = {
    Known{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Known{"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
    Known{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n",
          "uint32 seq\ntime stamp\nstring frame_id\n"},
    Known{"std_msgs/String", "string data\n"},
    Known{"std_msgs/Bool", "bool data\n"},
    Known{"std_msgs/Float32", "float32 data\n"},
    Known{"std_msgs/Float64", "float64 data\n"},
    Known{"std_msgs/Int32", "int32 data\n"},
    Known{"std_msgs/UInt32", "uint32 data\n"},
    Known{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Known{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    Known{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Known{"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"},
    Known{"geometry_msgs/Twist", "Vector3 linear\nVector3 angular\n"},
    Known{"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"},
    Known{"geometry_msgs/PoseWithCovariance", "Pose pose\nfloat64[36] covariance\n"},
    Known{"geometry_msgs/TwistWithCovariance", "Twist twist\nfloat64[36] covariance\n"},
    Known{"geometry_msgs/PoseStamped",
          "std_msgs/Header header\nPose pose\n",
          {},
          "d3812c3cbc69362b77dc0b19b345f8f5"},
    Known{"geometry_msgs/PointStamped", "std_msgs/Header header\nPoint point\n"},
    Known{"geometry_msgs/PoseWithCovarianceStamped", "std_msgs/Header header\nPoseWithCovariance pose\n"},
    Known{"geometry_msgs/TwistStamped",
          "std_msgs/Header header\nTwist twist\n",
          {},
          "98d34b0043a2093cf9d9345ab6eef12e"},
    Known{"geometry_msgs/TwistWithCovarianceStamped",
          "std_msgs/Header header\nTwistWithCovariance twist\n",
          {},
          "8927a1a12fb2607ceea095b2dc440a96"},
    Known{"geometry_msgs/Vector3Stamped",
          "std_msgs/Header header\nVector3 vector\n",
          {},
          "7b324c7325e683bf02a9b14b01090ec7"},
    Known{"geometry_msgs/TransformStamped",
          "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
    Known{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    Known{"nav_msgs/Odometry",
          "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
          "geometry_msgs/TwistWithCovariance twist\n",
          {},
          "cd5e73d190d741a2f92e81eda573aca7"},
    Known{"nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    Known{"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    Known{"diagnostic_msgs/DiagnosticStatus",
          "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n"},
    Known{"diagnostic_msgs/DiagnosticArray", "std_msgs/Header header\nDiagnosticStatus[] status\n"},
    Known{"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    Known{"sensor_msgs/PointCloud2",
          "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n"
          "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    Known{"sensor_msgs/Imu",
          "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
          "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
          "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
          "float64[9] linear_acceleration_covariance\n",
          {},
          "6a62c6daae103f4ff57a132d6f95cec2"},
    Known{"sensor_msgs/MagneticField",
          "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\n"
          "float64[9] magnetic_field_covariance\n",
          {},
          "2f3b0b43eed0c9501de0fa3ff89a45aa"},
    Known{"sensor_msgs/FluidPressure",
          "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n",
          {},
          "804dc5cea1c5306d6a2eb80b9833befe"},
    Known{"sensor_msgs/Temperature", "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n"},
    Known{"sensor_msgs/Range",
          "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\n"
          "float32 max_range\nfloat32 range\n",
          {},
          "c005c34273dc426c67a020a87bc24148"},
    Known{"sensor_msgs/LaserScan",
          "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
          "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
          "float32[] ranges\nfloat32[] intensities\n",
          {},
          "90c7ef2dc6895d81024acba2ac42f369"},
    Known{"sensor_msgs/Image",
          "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
          "uint32 step\nuint8[] data\n",
          {},
          "060021388200f6f0f447d0fcd9c64743"},
    Known{"sensor_msgs/CompressedImage",
          "std_msgs/Header header\nstring format\nuint8[] data\n",
          {},
          "8f7a12909da2c9d3332d540a0977563f"},
    Known{"foxglove_msgs/CompressedVideo",
          "builtin_interfaces/Time timestamp\nstring frame_id\nuint8[] data\nstring format\n",
          "time timestamp\nstring frame_id\nuint8[] data\nstring format\n",
          "c5ea945275bc0729ed72f42e057a67bd"},
    Known{"sensor_msgs/RegionOfInterest",
          "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    Known{"sensor_msgs/CameraInfo",
          "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
          "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
          "RegionOfInterest roi\n"},
    Known{"sensor_msgs/BatteryState",
          "std_msgs/Header header\nfloat32 voltage\nfloat32 temperature\nfloat32 current\nfloat32 charge\n"
          "float32 capacity\nfloat32 design_capacity\nfloat32 percentage\nuint8 power_supply_status\n"
          "uint8 power_supply_health\nuint8 power_supply_technology\nbool present\n"
          "float32[] cell_voltage\nfloat32[] cell_temperature\nstring location\nstring serial_number\n",
          {},
          "4ddae7f048e32fda22cac764685e3974",
          true},  // ROS 1 before Noetic has no temperatures
    Known{"sensor_msgs/JointState",
          "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
          {},
          "3066dcd76a6cfaef579bd0f34173e9fd"},
    // github.com/apl-ocean-engineering/marine_msgs
    Known{"marine_acoustic_msgs/Dvl",
          "std_msgs/Header header\nuint8 velocity_mode\nuint8 dvl_type\ngeometry_msgs/Vector3 velocity\n"
          "float64[9] velocity_covar\nfloat64 altitude\nfloat64 course_gnd\nfloat64 speed_gnd\n"
          "uint8 num_good_beams\nfloat32 sound_speed\nbool beam_ranges_valid\nbool beam_velocities_valid\n"
          "geometry_msgs/Vector3[4] beam_unit_vec\nfloat64[4] range\nfloat32[4] range_covar\n"
          "float32[4] beam_quality\nfloat32[4] beam_velocity\nfloat32[4] beam_velocity_covar\n",
          {},
          "f09bbfba6f467f84523073fb27d38e3e",
          true},
    // github.com/waterlinked/dvl-a50-ros-driver
    Known{"waterlinked_a50_ros_driver/DVLBeam", kA50Beam},
    Known{"waterlinked_a50_ros_driver/DVL",
          "std_msgs/Header header\nfloat64 time\ngeometry_msgs/Vector3 velocity\nfloat64 fom\nfloat64 "
          "altitude\n"
          "DVLBeam[] beams\nbool velocity_valid\nint64 status\nstring form\n",
          {},
          "dea1debc1aca7804a62c507714ec3777",
          true},
    // github.com/paagutie/dvl_msgs, for the driver dvl-a50 of ROS 2
    Known{"dvl_msgs/DVLBeam", kA50Beam},
    Known{"dvl_msgs/DVL",
          "std_msgs/Header header\nfloat64 time\ngeometry_msgs/Vector3 velocity\nfloat64 fom\n"
          "float64[] covariance\nfloat64 altitude\nDVLBeam[] beams\nbool velocity_valid\nint64 status\n"
          "int64 time_of_validity\nint64 time_of_transmission\nstring form\n",
          {},
          "c82a2ba376dad0651b1400be6c9227aa",
          true},
    // github.com/uuvsimulator/uuv_simulator, and COLA2 after it
    Known{"uuv_sensor_ros_plugins_msgs/DVLBeam", kSimulatedBeam},
    Known{"uuv_sensor_ros_plugins_msgs/DVL", kSimulatedDvl, {}, kSimulatedDvlChecksum, true},
    Known{"cola2_msgs/DVLBeam", kSimulatedBeam},
    Known{"cola2_msgs/DVL", kSimulatedDvl, {}, kSimulatedDvlChecksum, true},
    Known{"service_msgs/ServiceEventInfo",
          "uint8 event_type\nbuiltin_interfaces/Time stamp\nuint8[16] client_gid\nint64 sequence_number\n"},
    Known{"rcl_interfaces/Log",
          "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n"
          "string function\nuint32 line\n"},
    Known{"rcl_interfaces/ParameterValue",
          "uint8 type\nbool bool_value\nint64 integer_value\nfloat64 double_value\nstring string_value\n"
          "uint8[] byte_array_value\nbool[] bool_array_value\nint64[] integer_array_value\n"
          "float64[] double_array_value\nstring[] string_array_value\n"},
    Known{"rcl_interfaces/Parameter", "string name\nParameterValue value\n"},
    Known{"rcl_interfaces/ParameterEvent",
          "builtin_interfaces/Time stamp\nstring node\nParameter[] new_parameters\n"
          "Parameter[] changed_parameters\nParameter[] deleted_parameters\n"},
};

const Known* find(std::string_view type) {
  const auto* known =
      std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& entry) { return entry.type == type; });
  return known == kKnown.end() ? nullptr : known;
}

}  // namespace

std::optional<std::string_view> knownFields(std::string_view type, Serialization serialization) {
  const Known* known = find(type);
  if (known == nullptr) return std::nullopt;
  const bool is_special = serialization == Serialization::Ros1 && !known->ros1_fields.empty();
  return is_special ? known->ros1_fields : known->fields;
}

std::string_view ros1Checksum(std::string_view type) {
  const Known* known = find(type);
  return known == nullptr ? std::string_view() : known->ros1_checksum;
}

bool hasVersions(std::string_view type) {
  const Known* known = find(type);
  return known != nullptr && known->has_versions;
}

std::string fullDefinition(const std::string& type, Serialization serialization) {
  const TypeDescription description = parseDefinition(type, "", serialization);
  std::string text;
  for (const MessageDescription& message : description.messages) {
    const auto fields = knownFields(message.name, serialization);
    if (!fields) throw std::logic_error("no definition of " + message.name);
    if (!text.empty()) {
      text += fmt::format("{}\nMSG: {}\n", std::string(80, '='), message.name);
    }
    text += *fields;
  }
  return text;
}

}  // namespace lodeline::definitions
