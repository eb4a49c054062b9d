#pragma once

#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/estimator/trials/heading_trial.h"
#include "lodeline/problem/options/options.h"

namespace lodeline {

/// One dive of points among magnetic disturbances or near steel.
struct DisturbedDive {
  std::string name;
  uint64_t seed = 1;
  int cameras = 2;
  std::string imu_grade = "gx5-25";
  FieldTrouble trouble = FieldTrouble::None;  ///< of a cave dive
  bool is_wreck = false;                      ///< one lap around and through a steel hull instead
  bool knows_site = false;                    ///< the estimator has the Earth's field at the site
  double duration_s = 150.0;                  ///< of a cave dive
};

/// Twenty disturbed dives with two cameras and with one: iron beside the way, iron at the start, magnetite in
/// the walls, all of these together, and a wreck.
std::vector<DisturbedDive> disturbedDives();

/// The same caves without disturbance, with good and with noisy sensors.
std::vector<DisturbedDive> undisturbedDives();

/// Until then the field turns the first heading to north, s.
constexpr double kSettled_s = 20.0;

/// Errors of one run. Headings and positions are compared after the turn and shift that fit best.
struct DiveErrorsOfRun {
  double heading_rms_rad = 0.0;   ///< about its mean
  double settled_rms_rad = 0.0;   ///< the same from kSettled_s after the beginning on
  double position_rms_m = 0.0;    ///< after alignment in four degrees of freedom
  double north_rms_rad = 0.0;     ///< against north; of a run without north, against the first heading
  double north_end_rad = 0.0;     ///< over the last 10 s
  double claimed_rad = 0.0;       ///< root mean square of the claimed sigma of the heading
  double within_3_sigmas = 0.0;   ///< share of the frames whose north is within three claimed sigmas
  double most_sigmas = 0.0;       ///< largest error of north in claimed sigmas
  double used_share = 0.0;        ///< of the frames
  double readmitted_share = 0.0;  ///< of the frames
  double path_m = 0.0;
};

/// Samples of a run: heading errors by time.
struct DisturbedRun {
  DiveErrorsOfRun errors;
  std::vector<HeadingSample> samples;
  Diagnostics findings;
};

DisturbedRun runDisturbedDive(const DisturbedDive& dive, MagnetometerUse use,
                              const EstimatorOptions& estimator = {});

}  // namespace lodeline
