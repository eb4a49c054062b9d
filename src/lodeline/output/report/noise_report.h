#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/imu/noise/sensor_noise.h"

/// Output of `lodeline allan` on the noise of sensors at rest.
namespace lodeline {

/// Table for people: coefficients per axis with one sigma, and in the units of data sheets.
std::string noiseTable(const std::vector<SensorNoise>& sensors);

/// JSON: coefficients with sigmas, and the curves.
nlohmann::ordered_json noiseJson(const std::vector<SensorNoise>& sensors);

/// Kalibr's imu.yaml, an input of `lodeline run`. Densities are those of the mean variance of the axes.
/// Without a random walk in the record, the stated one reaches the Allan deviation of the bias instability at
/// 100 s. The filter models the instability by it.
std::string kalibrImuYaml(const SensorNoise& gyroscope, const SensorNoise& accelerometer);

/// The noise keys of mag0/sensor.yaml.
std::string magnetometerYaml(const SensorNoise& magnetometer);

/// Allan deviation of the axes and the fit, log-log; named allan_SENSOR.
gnuplot::Figure allanFigure(const SensorNoise& noise);

}  // namespace lodeline
