#pragma once

#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// Content of the messages of an Imu topic. Drivers of RealSense cameras publish gyroscope and accelerometer
/// in separate topics, each with zeros for the other sensor.
struct ImuContent {
  bool has_gyroscope = false;
  bool has_accelerometer = false;

  bool isWhole() const { return has_gyroscope && has_accelerometer; }
};

/// Reads a topic until both vectors were non-zero once; a complete IMU takes a few messages.
ImuContent contentOf(const BagTopic& topic, BagFile* bag);

}  // namespace lodeline
