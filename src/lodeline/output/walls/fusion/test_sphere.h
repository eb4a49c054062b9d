#pragma once

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/output/walls/fusion/tile_fusion.h"

namespace lodeline::test {

inline constexpr double kSphere_m = 1.5;

/// Views from inside a grey sphere about the origin, from places a little off its middle, in all directions.
inline DepthKeyframes sphereViews() {
  DepthKeyframes input;
  input.pinhole = {80, 80, 40.0, Vec2(39.5, 39.5)};
  for (size_t i = 0; i < 60; ++i) {
    const double k = static_cast<double>(i);
    const Quat turn = so3::exp(Vec3(std::sin(1.7 * k), std::cos(2.3 * k), std::sin(0.9 * k + 1.0)) * 2.2);
    const Vec3 place(0.3 * std::sin(k), 0.3 * std::cos(1.3 * k), 0.2 * std::sin(0.7 * k));
    DepthKeyframe keyframe{i, Time(), Rigid3(turn, place), {}};
    keyframe.box.extend(Vec3::Constant(-kSphere_m));
    keyframe.box.extend(Vec3::Constant(kSphere_m));
    input.keyframes.push_back(keyframe);
  }
  input.depths = [keyframes = input.keyframes, pinhole = input.pinhole](size_t number) {
    DepthImage image(cv::Size(pinhole.width_px, pinhole.height_px));
    image.colour = cv::Mat(image.depth.size(), CV_8UC3, cv::Scalar(30, 60, 90));
    const Rigid3& pose = keyframes[number].map_from_view;
    for (int v = 0; v < pinhole.height_px; ++v) {
      for (int u = 0; u < pinhole.width_px; ++u) {
        const Vec3 direction = pose.rotation * pinhole.direction(u, v);
        const double a = direction.squaredNorm(), b = pose.translation.dot(direction);
        const double c = pose.translation.squaredNorm() - kSphere_m * kSphere_m;
        image.set(u, v, (-b + std::sqrt(b * b - a * c)) / a, 0.01);
      }
    }
    return image;
  };
  return input;
}

}  // namespace lodeline::test
