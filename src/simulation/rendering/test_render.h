#pragma once

#include <memory>

#include "simulation/rendering/image_renderer.h"

namespace lodeline {

/// A short cave, a stereo rig and a motion through it, shared by tests, benchmark and preview of the
/// renderer. The body is the diver frame: x forward, y left, z up.
struct RenderFixture {
  static Centerline shortPassage(double length_m = 20.0, uint64_t seed = 3);
  static std::shared_ptr<const RenderWorld> shortCave();  ///< built once per process

  /// Two cameras 12 cm apart, the right one rotated by about half a degree; `scale` 1 is 640 x 480.
  static Rig stereoRig(double scale = 1.0);

  /// A slow swim along a passage at 0.3 m/s, starting at its second metre.
  static WorldFromBodyAt swim(const Centerline& passage);
};

}  // namespace lodeline
