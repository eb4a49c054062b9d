#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/io/rosbag1/bag_file.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Which topic of a bag is which sensor: cam0, cam1, …, imu0, mag0, pressure0, sonar0.
struct TopicChoice {
  std::map<std::string, const BagTopic*> topics;
  /// The other half of imu0, where its topic holds the gyroscope alone; null otherwise.
  const BagTopic* accelerometer = nullptr;

  const BagTopic* of(const std::string& sensor) const {
    const auto place = topics.find(sensor);
    return place == topics.end() ? nullptr : place->second;
  }
};

/// What is to be looked for.
struct TopicWish {
  std::vector<std::string> rig_cameras;      ///< all that the rig has
  std::vector<std::string> cameras;          ///< those to be used
  std::vector<std::string> sensors;          ///< imu0, mag0, …: those that the rig has
  std::map<std::string, std::string> named;  ///< topics by sensor, where they are told
};

/// Takes the topics that are named; finds the others by their type, images in the order of their names. Where
/// a camera publishes both raw and compressed images, the raw ones are taken. `imu0` may name two topics with
/// a comma between them, and finds two by itself, where they are the halves of an IMU (`imu_united`). Sensors
/// for which the bag has no topic are left out. What was found by type, and topics of sensors that the rig
/// does not have, are reported as notices. Throws InputError, listing the topics, where a named one is not
/// there or is of another type, where several would do, where there are more or fewer topics of images than
/// cameras, and for an IMU whose gyroscope or accelerometer is zero throughout.
TopicChoice chooseTopics(BagFile* bag, const TopicWish& wish, Diagnostics* diagnostics);

/// The topics of images by the order of their names, each camera once.
std::vector<const BagTopic*> imageTopics(const BagFile& bag);

/// Topics of a sensor (not a camera) by type.
std::vector<const BagTopic*> topicsFor(const BagFile& bag, const std::string& sensor);

}  // namespace lodeline
