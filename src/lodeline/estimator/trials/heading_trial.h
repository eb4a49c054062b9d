#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "simulation/dive/point_simulation.h"
#include "simulation/sensors/magnetometer_model.h"

namespace lodeline {

/// What the magnetometer of a simulated dive suffers from. In all cases it has soft and hard iron and 1
/// degree of misalignment, which its calibration knows.
enum class FieldTrouble {
  None,          ///< white noise alone
  HardIron,      ///< 0.3 uT that the calibration does not know
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
  AsBelieved,    ///< hard iron, its walk and a wandering field, drawn from what the estimator believes
};
const char* toString(FieldTrouble trouble);

/// A dive of points out and back, of which only the heading counts.
struct HeadingTrialOptions {
  uint64_t seed = 1;
  double duration_s = 1800.0;
  double frame_rate_hz = 5.0;
  int tracks = 60;
  int cameras = 2;
  std::string imu_grade = "gx5-25";  ///< of simulation/imu_model.h, with its magnetometer
  FieldTrouble trouble = FieldTrouble::None;
  double magnetometer_from_s = 0.0;            ///< no reading before, since the first frame
  std::optional<TimeSpan> magnetometer_pause;  ///< nor within
  double lamp_earliest_s = 30.0;               ///< it is first switched within 90 s from then on
  EstimatorOptions estimator;
  bool honest_imu = true;  ///< the estimator takes the IMU's noise for what it is (noise_inflation 1)
  /// Flicker noise of the biases, which the estimator's model has as a random walk.
  bool bias_instability = true;
};

struct HeadingSample {
  double time_s = 0.0;
  double error_rad = 0.0;           ///< against the estimate's own reference: north, or the first heading
  double sigma_rad = 0.0;           ///< claimed
  double finished_error_rad = 0.0;  ///< against north as known at the end, as in the files of a finished run
  MagnetometerStatus status = MagnetometerStatus::Off;
};

struct HeadingTrial {
  std::vector<HeadingSample> samples;  ///< of every frame
  HeadingReference reference = HeadingReference::Start;
  double correlated_noise_sigma_T = 0.0;  ///< of the field, as learned by the end
  double estimator_s = 0.0;               ///< processor time

  /// Root mean square over the samples from `begin_s` on.
  double rms(double begin_s = 60.0) const;
  double largest(double begin_s = 60.0) const;
  double finishedRms(double begin_s = 60.0) const;
  double claimed(double begin_s = 60.0) const;
  /// The same of a finished run for what is left when the mean error is taken off, as by aligning the
  /// trajectory.
  double alignedRms(double begin_s = 60.0) const;
  /// Of the frames, with a status.
  double share(MagnetometerStatus status) const;
};

HeadingTrial runHeadingTrial(const HeadingTrialOptions& options);

/// Is told of every frame of a trial's dive, with the estimator right after it.
using TrialObserver = std::function<void(const SimulatedFrame& frame, const FrameEstimate& estimate,
                                         const Estimator& estimator)>;

/// The dive of a heading trial, for whoever asks more of it than the heading. Gives the estimator's processor
/// time, s.
double runTrialDive(const HeadingTrialOptions& options, const TrialObserver& observe);

}  // namespace lodeline
