#pragma once

#include <optional>

#include "lodeline/estimate.h"
#include "lodeline/types.h"

namespace lodeline {

enum class MagnetometerUse {
  Automatic,  ///< Absolute with a calibrated magnetometer, else Off
  Absolute,   ///< relative to an estimated field of the world: MagnetometerFieldFactor
  Paper,      ///< readings of an interval relative to each other: MagnetometerRelativeFactor
  Off,
};

/// Limits within which a frame's field counts as the Earth's.
struct MagnetometerGateOptions {
  double max_norm_error = 0.04;  ///< relative to the estimated field
  double max_dip_error_rad = 0.07;
  double max_sigmas = 3.0;  ///< of the innovation, for each of the three
  /// Accepted deviation of an undisturbed field from the estimated one, per axis, beyond the covariance; one
  /// sigma.
  double field_sigma_T = 0.12e-6;
  /// A rejected magnetometer is accepted again after `release_s` within this share of the limits.
  double release_share = 0.5;
  double release_s = 4.0;
  /// After a rejection of this length the field is accepted as a new one, with a disturbance to be estimated.
  double readmission_s = 60.0;
  /// Time over which rejections reduce the weight of later readings.
  double memory_s = 60.0;
  /// A field of a wrong calibration or a magnet on board is not used. Two conditions over the last
  /// `rejection_window_s` show it. The time of rejection is longer than `max_rejected_ratio` of the time of
  /// agreement, and it exceeds this by more than `rejection_margin_s`. A good sensor among passing iron is
  /// rejected for a tenth to a third of the time.
  double rejection_window_s = 600.0;
  double max_rejected_ratio = 0.5;
  double rejection_margin_s = 90.0;  ///< longer than readmission_s, so that a new field is tried first
  /// A field also counts as such if the heading sigma from its time-correlated error (MagneticNoiseEstimator)
  /// is larger than this.
  double max_correlated_sigma_rad = 0.015;
  /// After this time it is tried again.
  double retry_after_s = 1800.0;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Limits of MagneticStepDetector, which detects that a current on board was switched.
struct MagneticStepDetectorOptions {
  bool enabled = true;
  double segment_s = 0.6;  ///< four of them in a row are compared
  double min_step_T = 0.1e-6;
  double max_step_T = 5e-6;
  double min_white_sigmas = 7.0;  ///< of the difference of two means of two segments
  double min_usual_sizes = 3.0;   ///< in units of the usual difference (root mean square over `memory_s`)
  double memory_s = 120.0;
  /// Before and after a step the field changes by no more than this share of the step from segment to
  /// segment, and in sum.
  double max_slope = 0.4;
  /// Minimum share of a step that is perpendicular to the change of the field by a heading error.
  double min_besides_heading = 0.3;
  double settling_s = 12.0;     ///< at the start, while tilt and heading become known
  double relative_sigma = 0.1;  ///< of a step's size, as measured
  /// The field counts as returned to the level before the step when less than this share of the step is left
  /// for `return_s`.
  double returned_share = 0.3;
  double return_s = 5.0;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct MagnetometerOptions {
  MagnetometerUse use = MagnetometerUse::Automatic;
  HeadingReference heading_reference = HeadingReference::Automatic;
  std::optional<Vec3> site_field_W;  ///< of the Earth where the dive is, east north up, T

  /// Time-correlated errors of the field: iron far away, currents, residual calibration errors. One sigma per
  /// axis, and the correlation time; frames within that time are not independent. `correlated_noise_sigma_T`
  /// is the initial value; MagneticNoiseEstimator estimates it from size and dip of the field.
  double correlated_noise_sigma_T = 0.05e-6;
  double correlated_noise_time_s = 5.0;
  double correlated_noise_memory_s = 300.0;
  /// Degrees of freedom of the Student distribution by which momentary deviations beyond the floor are
  /// weighted (StudentTWeight). The deviation is averaged over `deviation_s`.
  double student_dof = 4.0;
  double deviation_s = 1.0;
  double noise_inflation = 1.0;  ///< factor on the density of the magnetometer's white noise

  double field_sigma_T = 1e-4;  ///< of the field vector at the start
  /// Change of the hard iron between calibration and dive: 0.26 uT over the three axes. It is added (root of
  /// squares) to the sigma that the calibration states; a calibration without a stated sigma leaves more.
  double offset_sigma_T = 0.15e-6;
  double unstated_offset_sigma_T = 0.3e-6;
  double uncalibrated_offset_sigma_T = 10e-6;
  /// Effect of soft iron and axis misalignment of an uncalibrated magnetometer, relative to the field. It
  /// enlarges the reported heading covariance and does not change the estimate.
  double uncalibrated_axes_sigma = 0.03;
  double offset_walk_T_per_sqrt_s = 1e-9;  ///< 0.04 uT in half an hour
  double disturbance_sigma_T = 5e-6;
  double disturbance_walk_T_per_sqrt_s = 5e-8;

  double max_start_norm_error = 0.1;      ///< relative to the field at the site
  double max_start_dip_error_rad = 0.12;  ///< against the field at the site
  double min_horizontal_field_T = 5e-6;   ///< a smaller horizontal field gives no heading (polar regions)
  double declination_sigma_rad =
      0.006;  ///< of the field model and local rock, for a heading relative to true north

  /// Whether the field near steel is mapped on the first visit and used on the next (MappedField).
  bool map = false;

  MagnetometerGateOptions gate;
  MagneticStepDetectorOptions step;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

}  // namespace lodeline
