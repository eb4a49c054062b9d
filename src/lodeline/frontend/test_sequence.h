#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// Light and noise in the images of a TestSequence. Grey values follow `(ambient + lamp) * albedo + haze`,
/// where the albedo's mean is 1. Lamp and haze decrease with the distance from a point that is fixed in the
/// image, as with a lamp on the rig.
struct TestLight {
  double ambient_grey = 120.0;
  double lamp_grey = 0.0;          ///< in the centre of the pool
  double lamp_radius_px = 180.0;   ///< standard deviation of the pool
  double haze_grey = 0.0;          ///< backscatter in the centre of the pool
  double texture_contrast = 0.35;  ///< standard deviation of the albedo
  double noise_grey = 1.0;         ///< standard deviation of the sensor's noise

  static TestLight daylight() { return {}; }
  /// Rock of low contrast under a lamp, mean around 20 grey levels.
  static TestLight dimLamp() { return {2.0, 55.0, 180.0, 0.0, 0.18, 1.2}; }
  /// The same through milky water.
  static TestLight hazyLamp() { return {5.0, 60.0, 200.0, 90.0, 0.15, 1.5}; }
};

/// A stereo rig that swims along a rough wall (a textured plane), with exact ground truth for every pixel.
class TestSequence {
 public:
  explicit TestSequence(const TestLight& light, double speed_m_per_s = 0.3);

  const Rig& rig() const { return rig_; }
  static constexpr double kRateHz = 15.0;
  static Time time(int frame) { return Time::fromSeconds(100.0 + frame / kRateHz); }
  Rigid3 worldFromBody(int frame) const;
  /// Rotation from frame - 1 to frame.
  Quat previousFromCurrent(int frame) const;

  std::vector<cv::Mat> images(int frame) const;

  /// Pixel at which another camera at another time observes the point observed at `pixel`.
  std::optional<Vec2> truePixel(int frame, int camera, const Vec2& pixel, int other_frame,
                                int other_camera) const;

 private:
  Rigid3 worldFromCamera(int frame, int camera) const;
  std::optional<Vec3> wallPoint(int frame, int camera, const Vec2& pixel) const;
  float albedo(double x_m, double y_m) const;

  TestLight light_;
  double speed_m_per_s_;
  Rig rig_;
  cv::Mat texture_;  ///< CV_32F albedo of the wall
};

}  // namespace lodeline
