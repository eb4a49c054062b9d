#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/rendering/bodies/buddy.h"
#include "simulation/rendering/bodies/fish.h"
#include "simulation/rendering/light/daylight.h"
#include "simulation/rendering/light/halocline.h"
#include "simulation/rendering/light/lamp.h"
#include "simulation/rendering/light/marine_snow.h"
#include "simulation/rendering/light/second_diver.h"
#include "simulation/rendering/light/water.h"
#include "simulation/rendering/optics/camera_optics.h"
#include "simulation/rendering/optics/image_sensor.h"

namespace lodeline {

/// All settings of rendering for one dive, except the world.
struct RenderSettings {
  uint64_t seed = 1;
  std::vector<Lamp> lamps;
  Daylight daylight;
  WaterOptions water;
  SnowOptions snow;
  std::optional<SecondDiver> second_diver;
  std::vector<FishSchool> fish;
  std::shared_ptr<const Buddy> buddy;
  std::optional<Halocline> halocline;
  IntrinsicsOptions lens;
  SensorOptions sensor;
  bool motion_blur = true;
  bool dispersion = false;  ///< of water and port; needs a port

  /// Sets the current that carries snow, clouds in the water and fish.
  void setCurrent(std::shared_ptr<const DriftTrack> current) { water.current = snow.current = current; }

  /// Transforms the lamps from the diver frame D (x forward, y left, z up), which the presets use, to the
  /// body frame.
  void mountLamps(const Rigid3& diver_from_body);

  /// Preset: clear spring water, a good camera, every effect present but mild. The lamps are in the diver
  /// frame: see mountLamps.
  static RenderSettings clean();

  /// Preset for a real dive: milky water, a second diver's lamp, longer exposures, a varying gain. The
  /// scenario adds silt-outs and the flat port, because it knows their times and the calibration.
  static RenderSettings field();

  /// Preset for open water: daylight from above over lamps, clear sea.
  static RenderSettings openWater();

  /// Preset in air: diffuse room light, no lamps, nothing between camera and surfaces.
  static RenderSettings room();

  /// Preset without blur, snow and noise, with one constant exposure, for geometric measurements in the
  /// images.
  static RenderSettings ideal();
};

}  // namespace lodeline
