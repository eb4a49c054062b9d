#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline/estimator/trials/trial_currents.h"
#include "simulation/dive/point_simulation.h"
#include "simulation/sensors/magnetometer_model.h"

namespace lodeline {

/// Error of the magnetometer in a simulated dive. In all cases it has soft and hard iron and 1 degree of
/// misalignment, which its calibration contains.
enum class FieldTrouble {
  None,          ///< white noise alone
  HardIron,      ///< 0.3 uT that the calibration does not contain
  Disturbances,  ///< six of 20 s, 3 to 10 degrees each
  Tank,          ///< a companion's tank near for minutes, 8 degrees
  Dipole,        ///< iron lying in the passage, 15 degrees, passed both ways
  Calibration,   ///< hard iron wrong by 8 uT, soft iron by some per cent
  Lamp,          ///< a current of 0.1 to 0.4 uT, switched
  SoftIron,      ///< soft iron wrong by 10 %
  Misalignment,  ///< axes turned by 20 degrees
  Scale,         ///< corrected readings too large by half
  SwappedAxes,   ///< two axes taken for each other
  Boat,          ///< the first 30 s beside a boat of 13 uT, from which the diver swims away within 10 s
  AsBelieved,    ///< hard iron, its walk and a wandering field, drawn from the estimator's model
  Beside,        ///< a dipole every 8 m beside the way, 12 to 30 degrees each
  AtStart,       ///< iron at the start, 6 to 20 degrees
  Magnetite,     ///< in all walls, about 1 uT
  Together,      ///< these three
};
const char* toString(FieldTrouble trouble);

/// Options of a dive with simulated points out and back, in which only the heading is evaluated.
struct HeadingTrialOptions {
  uint64_t seed = 1;
  double duration_s = 1800.0;
  double frame_rate_hz = 5.0;
  int tracks = 60;
  int cameras = 2;
  std::string imu_grade = "gx5-25";  ///< of simulation/sensors/imu_model.h, with its magnetometer
  FieldTrouble trouble = FieldTrouble::None;
  double magnetometer_from_s = 0.0;                  ///< no reading before, since the first frame
  std::optional<MotionInterval> magnetometer_pause;  ///< nor within
  /// Number of times that one lamp with one field is switched on and off at even intervals; 0: times and
  /// sizes are drawn.
  int lamp_switchings = 0;
  double lamp_earliest_s = 30.0;                ///< the lamp is first switched within 90 s from then on
  std::optional<TrialCurrentOptions> currents;  ///< electric currents that disturb the magnetometer
  std::function<void(MagnetometerCalibration*)> spoil;  ///< changes the calibration that the estimator gets
  EstimatorOptions estimator;
  bool honest_imu = true;  ///< the estimator uses the IMU's true noise (noise_inflation 1)
  /// Flicker noise of the biases, which the estimator models as a random walk.
  bool bias_instability = true;

  /// The Earth's field in the world of the trial, T: to magnetic north, as in Florida.
  static Vec3 field_W() { return Vec3(0.0, 24.2e-6, -38.6e-6); }
};

struct HeadingSample {
  double time_s = 0.0;
  double error_rad = 0.0;           ///< relative to the estimate's own reference: north, or the first heading
  double sigma_rad = 0.0;           ///< reported
  double finished_error_rad = 0.0;  ///< relative to north as estimated at the end of the run
  MagnetometerStatus status = MagnetometerStatus::Off;
};

struct HeadingTrial {
  std::vector<HeadingSample> samples;  ///< of every frame
  HeadingReference reference = HeadingReference::Start;
  double correlated_noise_sigma_T = 0.0;  ///< of the field, as estimated at the end
  double estimator_s = 0.0;               ///< processor time
  Diagnostics findings;
  std::map<std::string, int> current_status;  ///< frames by the status of the compensation of currents

  /// Root mean square over the samples from `begin_s` on.
  double rms(double begin_s = 60.0) const;
  double largest(double begin_s = 60.0) const;
  double finishedRms(double begin_s = 60.0) const;
  double claimed(double begin_s = 60.0) const;
  /// Root mean square error of a finished run after subtraction of the mean error, as in an alignment of the
  /// trajectory.
  double alignedRms(double begin_s = 60.0) const;
  /// Share of the frames with a status.
  double share(MagnetometerStatus status) const;
};

HeadingTrial runHeadingTrial(const HeadingTrialOptions& options);

/// Called for every frame of a trial's dive, with the estimator right after it.
using TrialObserver = std::function<void(const SimulatedFrame& frame, const FrameEstimate& estimate,
                                         const Estimator& estimator)>;

/// Runs the dive of a heading trial with an observer, for evaluations beyond the heading. Returns the
/// estimator's processor time, s. `diagnostics`: for the estimator's findings, or null.
double runTrialDive(const HeadingTrialOptions& options, const TrialObserver& observe,
                    Diagnostics* diagnostics = nullptr);

}  // namespace lodeline
