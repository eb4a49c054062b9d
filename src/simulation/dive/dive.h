#pragma once

#include <memory>
#include <optional>

#include "lodeline/board/calibration_board.h"
#include "simulation/dive/dive_errors.h"
#include "simulation/motion/posed_motion.h"
#include "simulation/plan/cave_plan.h"
#include "simulation/rendering/bodies/buddy.h"
#include "simulation/rendering/bodies/fish.h"
#include "simulation/rendering/cave/centerline.h"
#include "simulation/rendering/light/halocline.h"
#include "simulation/rendering/seabed/sea_floor.h"
#include "simulation/sensors/landmark_field.h"
#include "simulation/shared/motion.h"
#include "simulation/vehicle/vehicle_currents.h"
#include "simulation/vehicle/vehicle_thrust.h"

namespace lodeline {

/// A calibration board and its place.
struct PlacedBoard {
  CalibrationBoard board;
  Rigid3 world_from_board;
};

/// The cave of a scenario with a cave seed, in its own frame C (east, north, up).
struct FramedCave {
  CaveLayout layout;
  std::vector<LineTag> tags;
  Vec3 origin_W = Vec3::Zero();  ///< of C in the world of the dive, m
};

/// A scenario with all its random draws: place, motion, rig and its errors.
struct Dive {
  Scenario scenario;
  DiveErrors errors;
  Motion motion;
  std::optional<Centerline> passage;  ///< in a cave, world frame; first track of a route
  std::optional<FramedCave> cave;
  std::optional<WreckLayout> wreck;  ///< in open water, world frame
  std::optional<SeaFloorOptions> sea_floor;
  std::optional<PlacedBoard> board;  ///< of a camera calibration
  Vec3 field_W = Vec3::Zero();       ///< Earth's, T
  MagneticDisturbances disturbances;
  std::shared_ptr<const VehicleThrust> thrust;  ///< of a vehicle under way
  LoadsFunction loads;                          ///< electric ones of a vehicle
  std::shared_ptr<const DriftTrack> current;    ///< nothing in still water
  std::vector<FishSchool> fish;
  std::shared_ptr<const Buddy> buddy;  ///< nothing where no diver is in view
  std::optional<Halocline> halocline;
  Vec3 gravity_W = Vec3(0.0, 0.0, -9.80665);
  double surface_height_m = 0.0;  ///< height of the water surface above the world's origin
  Time start;                     ///< stamp at second 0 of the motion, on the IMU's clock
};

/// Draws a dive; deterministic in the scenario. Throws UsageError for lengths and durations that no diver can
/// swim.
Dive makeDive(const Scenario& scenario);

/// Points on the walls (cave) or hull (wreck) of the dive, for point-level simulation; empty without a place.
LandmarkField diveLandmarks(const Dive& dive, double points_per_metre = 400.0);

}  // namespace lodeline
