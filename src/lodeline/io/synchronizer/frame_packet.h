#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/sensors/measurements.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// Everything the sensors said between one moment of images and the next.
struct FramePacket {
  Time time;         ///< mid-exposure of the images, on the IMU's clock
  Time image_stamp;  ///< the same moment as the recording wrote it: the stamp of the first camera's image

  /// One 8-bit grey image per camera of the rig; empty where the camera gave none.
  std::vector<cv::Mat> images;
  /// By how much later than `time` each camera's image was taken, s; 0 for the first camera.
  std::vector<double> image_delays_s;

  /// From the time of the packet before to `time`, readings at both ends interpolated, strictly increasing in
  /// time. The first packet holds the readings kept from before the first image, so that the tilt can be
  /// averaged.
  std::vector<ImuSample> imu;
  /// From `time` to the latest of the images, where one is later; interpolated at both ends.
  std::vector<ImuSample> imu_ahead;
  /// Longest time between two true (not interpolated) readings that the interval of `imu` touches, s; more
  /// than a few nominal periods means data was lost and the interpolation bridges it.
  double longest_imu_gap_s = 0.0;

  /// Readings in (time of the packet before, time].
  std::vector<MagnetometerSample> magnetometer;
  std::vector<DepthSample> depth;
  std::vector<SonarSample> sonar;

  /// Puts the readings of the packet before this one, which is not to be used, in front of its own.
  void prepend(FramePacket before);
};

}  // namespace lodeline
