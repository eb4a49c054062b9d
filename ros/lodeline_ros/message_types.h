#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <memory>
#include <type_traits>

/// ROS's message types for C++20. The headers that ROS generates, and its serialization of vectors, need
/// `rebind` in the allocator, which C++20 removed from std::allocator. The allocator below has it. Strings
/// stay std::string.
namespace lodeline::message {

template <typename T>
struct VectorAllocator : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = std::conditional_t<std::is_same_v<U, char>, std::allocator<char>, VectorAllocator<U>>;
  };

  VectorAllocator() = default;
  template <typename U>
  VectorAllocator(const VectorAllocator<U>&) noexcept {}
};
using Allocator = VectorAllocator<void>;

using DiagnosticArray = diagnostic_msgs::DiagnosticArray_<Allocator>;
using DiagnosticStatus = diagnostic_msgs::DiagnosticStatus_<Allocator>;
using KeyValue = diagnostic_msgs::KeyValue_<Allocator>;
using Odometry = nav_msgs::Odometry_<Allocator>;
using Path = nav_msgs::Path_<Allocator>;
using Point = geometry_msgs::Point_<Allocator>;
using PointCloud2 = sensor_msgs::PointCloud2_<Allocator>;
using PointField = sensor_msgs::PointField_<Allocator>;
using Pose = geometry_msgs::Pose_<Allocator>;
using PoseStamped = geometry_msgs::PoseStamped_<Allocator>;
using PoseWithCovarianceStamped = geometry_msgs::PoseWithCovarianceStamped_<Allocator>;
using Quaternion = geometry_msgs::Quaternion_<Allocator>;
using TFMessage = tf2_msgs::TFMessage_<Allocator>;
using TransformStamped = geometry_msgs::TransformStamped_<Allocator>;
using Twist = geometry_msgs::Twist_<Allocator>;
using Vector3 = geometry_msgs::Vector3_<Allocator>;

}  // namespace lodeline::message
