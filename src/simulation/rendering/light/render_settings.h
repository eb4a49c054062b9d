#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/rendering/light/daylight.h"
#include "simulation/rendering/light/lamp.h"
#include "simulation/rendering/light/marine_snow.h"
#include "simulation/rendering/light/second_diver.h"
#include "simulation/rendering/light/water.h"
#include "simulation/rendering/optics/camera_optics.h"
#include "simulation/rendering/optics/image_sensor.h"

namespace lodeline {

/// Everything between the world and the images of one dive.
struct RenderSettings {
  uint64_t seed = 1;
  std::vector<Lamp> lamps;
  Daylight daylight;
  WaterOptions water;
  SnowOptions snow;
  std::optional<SecondDiver> second_diver;
  IntrinsicsOptions lens;
  SensorOptions sensor;
  bool motion_blur = true;

  /// Turns the lamps from the diver frame D (x forward, y left, z up), in which the presets give them, into
  /// the body frame.
  void mountLamps(const Rigid3& diver_from_body);

  /// Clear spring water, a good camera, every effect present but mild. The lamps stand in the diver
  /// frame: see mountLamps.
  static RenderSettings clean();

  /// What a diver gets: milky water, a companion's lamp, longer exposures, a flickering gain. Silt-outs and
  /// the flat port are added by the scenario, which knows their times and the calibration.
  static RenderSettings field();

  /// Open water: daylight from above over lamps, clear sea.
  static RenderSettings openWater();

  /// Without blur, snow and noise, exposed once for all: for measuring geometry in the images.
  static RenderSettings ideal();
};

}  // namespace lodeline
