#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// Topic of each sensor: cam0, cam1, …, imu0, mag0, pressure0, ….
struct TopicChoice {
  std::map<std::string, const BagTopic*> topics;
  /// Accelerometer topic of imu0, where its own topic has only the gyroscope; null otherwise.
  const BagTopic* accelerometer = nullptr;

  const BagTopic* of(const std::string& sensor) const {
    const auto place = topics.find(sensor);
    return place == topics.end() ? nullptr : place->second;
  }
};

/// Sensors for which topics are needed.
struct TopicWish {
  std::vector<std::string> rig_cameras;      ///< all cameras of the rig
  std::vector<std::string> cameras;          ///< cameras to use
  std::vector<std::string> sensors;          ///< other sensors of the rig: imu0, mag0, …
  std::map<std::string, std::string> named;  ///< given topics by sensor
};

/// Selects a topic for each sensor. Named topics have priority. Other topics are found by their type, those
/// of images in the order of their names. Where a camera publishes both raw and compressed images, the raw
/// ones are selected. Where the IMU is divided, `imu0` may name two topics with a comma between them; without
/// names, the function finds the two (`imu_united`). Sensors without a topic in the bag are left out. Topics
/// found by type, and topics of sensors that the rig does not have, are reported as notices.
///
/// Throws InputError listing the topics in these cases: a named topic is missing or has another type, several
/// topics fit, or the numbers of image topics and cameras differ. Also throws it for an IMU whose gyroscope
/// or accelerometer is always zero.
TopicChoice chooseTopics(BagFile* bag, const TopicWish& wish, Diagnostics* diagnostics);

/// Image topics in the order of their names, one per camera.
std::vector<const BagTopic*> imageTopics(const BagFile& bag);

/// Topics of a sensor (not a camera), found by type.
std::vector<const BagTopic*> topicsFor(const BagFile& bag, const std::string& sensor);

}  // namespace lodeline
