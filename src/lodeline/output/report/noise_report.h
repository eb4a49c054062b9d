#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/imu/noise/sensor_noise.h"

/// What `lodeline allan` tells of the noise of sensors at rest.
namespace lodeline {

/// For people: coefficients per axis with one sigma, and in the units of data sheets.
std::string noiseTable(const std::vector<SensorNoise>& sensors);

/// For programs: coefficients with sigmas, and the curves.
nlohmann::ordered_json noiseJson(const std::vector<SensorNoise>& sensors);

/// Kalibr's imu.yaml, which `lodeline run` takes beside a recording. Densities are those of the mean variance
/// of the axes. Where the record shows no random walk, the one stated reaches the bias instability's Allan
/// deviation at 100 s, as a filter without another place for it needs.
std::string kalibrImuYaml(const SensorNoise& gyroscope, const SensorNoise& accelerometer);

/// The keys of mag0/sensor.yaml that speak of noise.
std::string magnetometerYaml(const SensorNoise& magnetometer);

/// Allan deviation of the axes and what was fitted, log-log; named allan_SENSOR.
gnuplot::Figure allanFigure(const SensorNoise& noise);

}  // namespace lodeline
