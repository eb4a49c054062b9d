#pragma once

#include <optional>
#include <string>

/// Names of topics and types as ROS 2 gives them to DDS
/// (design.ros2.org/articles/topic_and_service_names.html and the package rmw_dds_common).
namespace lodeline::dds {

/// "/camera/image_raw" for "camera/image_raw" in the namespace "/"; absolute names keep theirs. Throws
/// UsageError for a name that ROS 2 does not accept.
std::string fullName(const std::string& topic, const std::string& name_space);

/// "rt/camera/image_raw" for "/camera/image_raw".
std::string ddsTopic(const std::string& full_name);

/// "sensor_msgs::msg::dds_::Imu_" for "sensor_msgs/Imu".
std::string ddsType(const std::string& type);

/// "sensor_msgs/Imu" for "sensor_msgs::msg::dds_::Imu_"; nothing for a type that is no message of ROS 2.
std::optional<std::string> rosType(const std::string& dds_type);

/// The domain in ROS_DOMAIN_ID, or 0. Throws UsageError where its value is no domain.
int domainOfEnvironment();

/// Throws UsageError for a domain for which UDP has no ports.
void checkDomain(int64_t domain, const std::string& source);

}  // namespace lodeline::dds
