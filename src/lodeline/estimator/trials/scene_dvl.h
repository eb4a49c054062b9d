#pragma once

#include <functional>
#include <vector>

#include "lodeline/estimator/trials/scene.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Test support: what is wrong with the DVL of a scene.
struct SceneDvlErrors {
  double scale = 0.0;                    ///< relative
  Vec3 misalignment_rad = Vec3::Zero();  ///< of body_from_dvl, axes of D
  double noise_m_per_s = 0.005;          ///< of each beam, or of each axis
  bool has_beams = true;                 ///< else a velocity
  double missing_share = 0.0;            ///< of the beams
  double sentinel_share = 0.0;           ///< of the beams, which show -2.0 or 0.0
  /// Velocity of the water, m/s, world axes. All velocities are those through the water then.
  std::function<Vec3(double time_s)> current_W = {};
  std::function<void(double time_s, DvlSample*)> spoil = {};
};

/// The pings of a DVL on the rig of a scene, from the true motion at their own times.
class SceneDvl {
 public:
  SceneDvl(const TestScene& scene, const DvlCalibration& dvl, const TestSceneOptions& options,
           SceneDvlErrors errors = {});

  /// A DVL below the body and behind it that looks down, with the x axis forward.
  static DvlCalibration lookingDown();

  /// The pings since the last call, up to `end`.
  std::vector<DvlSample> until(Time end);

 private:
  DvlSample pingAt(double time_s);

  const TestScene& scene_;
  DvlCalibration dvl_;
  Time start_;
  SceneDvlErrors errors_;
  Random random_;
  int64_t next_ = 0;
};

}  // namespace lodeline
