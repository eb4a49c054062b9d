#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/rig.h"
#include "lodeline/sensors/sensor_readings.h"
#include "lodeline/types.h"

namespace lodeline {

/// All sensor readings between one image time and the next.
struct FramePacket {
  Time time;         ///< mid-exposure of the first camera's image, on the IMU's clock
  Time image_stamp;  ///< stamp of the first camera's image as recorded, for the same moment

  /// One 8-bit grey image per camera of the rig; empty where the camera has none.
  std::vector<cv::Mat> images;
  /// Delay of each camera's image relative to `time`, s; 0 for the first camera.
  std::vector<double> image_delays_s;

  /// Readings from the time of the previous packet to `time`, strictly increasing in time and interpolated at
  /// both ends. The first packet has the history before the first image, from which the tilt can be averaged.
  std::vector<ImuSample> imu;
  /// Readings from `time` to the latest image, where one is later; interpolated at both ends.
  std::vector<ImuSample> imu_ahead;
  /// Longest time between two real (not interpolated) readings that overlaps the interval of `imu`, s. More
  /// than a few nominal periods means that data was lost and interpolation bridges it.
  double longest_imu_gap_s = 0.0;

  /// Readings of the other sensors in (time of the previous packet, time].
  SensorReadings readings;

  /// Inserts the readings of the previous packet, which is not used, before those of this one.
  void prepend(FramePacket before);
};

}  // namespace lodeline
