#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace lodeline {

/// An 8-bit grey image sensor with automatic exposure.
struct SensorOptions {
  double electrons_per_radiance_s = 4.0e6;  ///< per pixel, per W/m^2/sr and second of exposure
  double full_well_e = 10000.0;
  double read_noise_e = 5.0;
  bool noise = true;
  double gamma = 0.6;  ///< grey value ~ light^gamma; keeps contrast in dark water
  double shortest_exposure_s = 0.0005;
  double longest_exposure_s = 0.012;
  double highest_gain = 12.0;
  double target_grey = 0.36;    ///< target mean grey value of the automatic exposure, relative to 1
  double exposure_lag_s = 0.4;  ///< time constant of the automatic exposure
  double gain_flicker = 0.0;    ///< RMS relative error of the gain from image to image
  double readout_s = 0.0;  ///< rolling shutter: time in which all rows begin one after another; 0 is global

  /// Time from one row to the next, s.
  double lineDelay_s(int height_px) const { return readout_s / height_px; }
};

/// Exposure setting of one image.
struct ExposureSetting {
  double exposure_s = 0.01;
  double gain = 1.0;  ///< 1: a full well is white
};

/// Splits a wanted exposure: the exposure time increases first, then, at its maximum, the gain. `wanted_s` is
/// the exposure time at gain 1.
ExposureSetting splitExposure(const SensorOptions& sensor, double wanted_s);

/// Exposure time at gain 1 for which these radiances (already vignetted) have the target mean grey.
double meteredExposure(const SensorOptions& sensor, const std::vector<float>& radiances);

/// Converts radiance (CV_32F, vignetted) to grey values: photon shot noise (Poisson, here normal with the
/// same variance), read noise, gain, clipping, tone curve. The noise depends only on `noise_seed` and the
/// pixel.
cv::Mat develop(const cv::Mat& radiance, const SensorOptions& sensor, const ExposureSetting& setting,
                uint64_t noise_seed);

}  // namespace lodeline
