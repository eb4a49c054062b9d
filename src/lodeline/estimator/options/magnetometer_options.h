#pragma once

#include <optional>

#include "lodeline/geometry/types.h"

namespace lodeline {

enum class MagnetometerUse {
  Automatic,  ///< Absolute with a calibrated magnetometer, else Off
  Absolute,   ///< against an estimated field of the world: MagnetometerFieldFactor
  Paper,      ///< readings of an interval against each other: MagnetometerRelativeFactor
  Off,
};

/// What the world's y axis points to.
enum class HeadingReference {
  Automatic,  ///< True where the field at the site is known, else Magnetic
  True,
  Magnetic,
  Start,  ///< the world is turned so that the first pose has no yaw
};
const char* toString(HeadingReference reference);

/// When a frame's field is taken for the Earth's.
struct MagnetometerGateOptions {
  double max_norm_error = 0.04;  ///< relative to the estimated field
  double max_dip_error_rad = 0.07;
  double max_sigmas = 3.0;  ///< of the innovation, for each of the three
  /// How far an undisturbed field may be from the estimated one, per axis, beyond what its covariance says.
  double field_sigma_T = 0.12e-6;
  /// A rejected magnetometer is believed again after so long within this share of the limits.
  double release_share = 0.5;
  double release_s = 4.0;
  /// After so long a rejection its field is taken as a new one, with a disturbance to be estimated.
  double readmission_s = 60.0;
  /// Over which rejections lower the weight of what is used.
  double memory_s = 60.0;
  /// A field that within the last `rejection_window_s` was rejected for longer than `max_rejected_ratio` of
  /// the time for which it agreed, by more than `rejection_margin_s`, is that of a wrong calibration or of a
  /// magnet on board: nothing of it is used. A good sensor among passing iron is rejected for a tenth to a
  /// third of the time.
  double rejection_window_s = 600.0;
  double max_rejected_ratio = 0.5;
  double rejection_margin_s = 90.0;  ///< longer than readmission_s, so that a new field is tried before that
  /// The same is said of a field whose lasting error (MagneticNoiseEstimator) is worth more of heading than
  /// this.
  double max_correlated_sigma_rad = 0.015;
  /// After so long it is tried again, even so.
  double retry_after_s = 1800.0;
};

/// When a change of the field is taken for a current on board that was switched (MagneticStepDetector).
struct MagneticStepDetectorOptions {
  bool enabled = true;
  double segment_s = 0.6;  ///< four of them in a row are compared
  double min_step_T = 0.1e-6;
  double max_step_T = 5e-6;
  double min_white_sigmas = 7.0;  ///< of the difference of two means of two segments
  double min_usual_sizes = 3.0;   ///< of the usual difference (root mean square over `memory_s`)
  double memory_s = 120.0;
  /// Before and after a step the field changes by no more than this share of it from segment to segment,
  /// in sum too.
  double max_slope = 0.4;
  /// Least share of a step that is not along the direction in which an error of heading shows.
  double min_besides_heading = 0.3;
  double settling_s = 12.0;     ///< at the start, while tilt and heading become known
  double relative_sigma = 0.1;  ///< of a step's size, as it is measured
  /// The first level is back when less than this share of the step is left of it for `return_s`.
  double returned_share = 0.3;
  double return_s = 5.0;
};

struct MagnetometerOptions {
  MagnetometerUse use = MagnetometerUse::Automatic;
  HeadingReference heading_reference = HeadingReference::Automatic;
  std::optional<Vec3> site_field_W;  ///< of the Earth where the dive is, east north up, T

  /// Errors of the field that last: iron far away, currents, what calibration leaves. One sigma per axis, and
  /// the time over which they stay the same; frames within that time are not independent witnesses.
  /// `correlated_noise_sigma_T` is where it starts; size and dip of the field teach better
  /// (MagneticNoiseEstimator).
  double correlated_noise_sigma_T = 0.05e-6;
  double correlated_noise_time_s = 5.0;
  double correlated_noise_memory_s = 300.0;
  /// What deviates at a moment by more than the floor weighs as a draw of a Student distribution of so many
  /// degrees of freedom (StudentTWeight), its deviation averaged over `deviation_s`.
  double student_dof = 4.0;
  double deviation_s = 1.0;
  double noise_inflation = 1.0;  ///< factor on the density of the magnetometer's white noise

  double field_sigma_T = 1e-4;  ///< of the field vector at the start
  /// Hard iron that comes between calibration and dive: 0.26 uT over the three axes. Joined by the sigma that
  /// the calibration states; one that states none leaves more.
  double offset_sigma_T = 0.15e-6;
  double unstated_offset_sigma_T = 0.3e-6;
  double uncalibrated_offset_sigma_T = 10e-6;
  /// Of one that was never calibrated, too: what soft iron and turned axes make of the field, relative to it.
  /// Counts in what is claimed of the heading, not in what is estimated.
  double uncalibrated_axes_sigma = 0.03;
  double offset_walk_T_per_sqrt_s = 1e-9;  ///< 0.04 uT in half an hour
  double disturbance_sigma_T = 5e-6;
  double disturbance_walk_T_per_sqrt_s = 5e-8;

  /// Of the first heading, before the field is heard: no more than enough to keep the first steps small.
  double start_yaw_sigma_rad = 0.5;
  double max_start_norm_error = 0.1;      ///< relative to the field at the site
  double max_start_dip_error_rad = 0.12;  ///< against the field at the site
  double min_horizontal_field_T = 5e-6;   ///< less has no heading (polar regions)
  double declination_sigma_rad =
      0.006;  ///< of the field model and the rock, for a heading against true north

  MagnetometerGateOptions gate;
  MagneticStepDetectorOptions step;
};

}  // namespace lodeline
