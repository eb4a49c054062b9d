#pragma once

namespace lodeline {

/// Options of the fusion of ranges by sonar, altimeter and DVL (docs/theory/sonar.md).
struct SonarOptions {
  bool use = true;
  double noise_inflation = 1.0;  ///< factor on range_noise_std of the sensor's file
  /// Landmarks within this angle of the beam form the surface that it meets; at least half of the beam's
  /// width.
  double surface_angle_rad = 0.2;
  int min_landmarks = 6;   ///< with fewer, an echo is not used
  int max_landmarks = 16;  ///< those nearest to the beam
  /// Largest leverage of the beam on the plane through the landmarks (BeamSurface::leverage): a plane that
  /// lies beside the beam is not extrapolated.
  double max_leverage = 1.0;
  /// Roughness of walls within that angle, relative to the range, beside the scatter of the landmarks.
  double roughness = 0.02;
  /// Correlation time of the errors of the surface: a beam meets the same landmarks for that long.
  double correlated_noise_time_s = 0.3;
  double robust_scale_sigmas = 2.0;  ///< width of the Cauchy loss
  /// An echo is rejected beyond this number of sigmas of the innovation. The predicted range has the scale's
  /// sigma, within the limits below.
  double max_sigmas = 4.0;
  double least_scale_sigma = 0.05;
  double greatest_scale_sigma = 0.5;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

}  // namespace lodeline
