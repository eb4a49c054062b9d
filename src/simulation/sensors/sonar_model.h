#pragma once

#include <functional>
#include <optional>

#include "lodeline/rig.h"
#include "simulation/shared/motion.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Distance to the first surface from a point along a unit direction, both in W, m; nothing where there is
/// none.
using RangeFunction = std::function<std::optional<double>(const Vec3& origin_W, const Vec3& direction_W)>;

/// A pencil-beam sonar whose head rotates at a constant rate about its z axis, all around or within a sector;
/// at angle 0 the beam points along x. An altimeter is one whose head does not rotate.
struct SonarErrors {
  double noise_m = 0.0;
  double dropout_share = 0.0;   ///< fraction of randomly lost echoes
  double spurious_share = 0.0;  ///< fraction of echoes before the wall: silt, bubbles, the diver's fins
  double nearest_m = 0.2;
  double farthest_m = 6.0;
  double resolution_m = 0.0;  ///< 0: continuous
  double turn_rad_per_s = 0.63;
  /// The head turns to and fro within this angle of its x axis; 0: all around.
  double sector_rad = 0.0;
};

class SonarModel {
 public:
  /// `motion` must outlive the model.
  SonarModel(const Motion& motion, const Rigid3& body_from_sonar, RangeFunction range,
             const SonarErrors& errors, uint64_t seed, std::string_view random_stream = "sonar");

  /// The echo at `time_s` (the caller sets its time); nothing where it is too far, too near, or lost.
  std::optional<SonarSample> measure(double time_s);

 private:
  double angleAt_rad(double time_s) const;

  const Motion& motion_;
  Rigid3 body_from_sonar_;
  RangeFunction range_;
  SonarErrors errors_;
  Random random_;
};

}  // namespace lodeline
