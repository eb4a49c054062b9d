#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lodeline/simulation/camera_optics.h"
#include "lodeline/simulation/daylight.h"
#include "lodeline/simulation/image_sensor.h"
#include "lodeline/simulation/lamp.h"
#include "lodeline/simulation/marine_snow.h"
#include "lodeline/simulation/second_diver.h"
#include "lodeline/simulation/water.h"

namespace lodeline {

/// Everything between the world and the images of one dive.
struct RenderSettings {
  uint64_t seed = 1;
  std::vector<Lamp> lamps;
  Daylight daylight;
  WaterOptions water;
  SnowOptions snow;
  std::optional<SecondDiver> second_diver;
  LensOptions lens;
  SensorOptions sensor;
  bool motion_blur = true;

  /// Clear spring water, a good camera, every effect present but mild. The lamps are for a body frame with x
  /// forward, y left, z up.
  static RenderSettings clean();

  /// What a diver gets: milky water, a companion's lamp, longer exposures, a flickering gain. Silt-outs and
  /// the flat port are added by the scenario, which knows their times and the calibration.
  static RenderSettings field();

  /// Without blur, snow and noise, exposed once for all: for measuring geometry in the images.
  static RenderSettings ideal();
};

}  // namespace lodeline
