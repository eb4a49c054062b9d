#include "lodeline/output/report/noise_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lodeline/imu/gravity.h"

namespace lodeline {
namespace {

constexpr double kWalkReference_s = 100.0;
constexpr const char* kConventions =
    "Densities are two-sided, as Kalibr and Lodeline take them: a reading at rate f scatters by density * "
    "sqrt(f).\nThe one-sided convention of some data sheets is sqrt(2) times as large. sigma is one standard "
    "deviation;\n'<' marks a 95 % bound on what the record is too short to show. Allan deviation of bias "
    "instability: 0.664 B.\n";

/// A sensor's coefficients in the units of data sheets.
struct DataSheetUnits {
  double white, instability, walk;  ///< factors from SI
  const char *white_unit, *instability_unit, *walk_unit;
};

DataSheetUnits dataSheetUnits(const AnalysedSensor& sensor) {
  const double degree = 180.0 / std::numbers::pi;
  const double milli_g = 1e3 / kStandardGravity;
  if (sensor.name == "gyroscope")
    return {degree, 3600.0 * degree, 3600.0 * degree, "deg/s/sqrtHz", "deg/h", "deg/h/s/sqrtHz"};
  if (sensor.name == "accelerometer")
    return {1e3 * milli_g, milli_g, 1e3 * milli_g, "ug/sqrtHz", "mg", "ug/s/sqrtHz"};
  return {1e9, 1e9, 1e9, "nT/sqrtHz", "nT", "nT/s/sqrtHz"};
}

std::string cell(const NoiseFigure& figure) {
  if (!figure.resolved) return fmt::format("< {:.3g}", figure.at_most);
  return fmt::format("{:.4g} +- {:.1g}", figure.value, figure.sigma);
}

std::string row(const SensorNoise& noise, const char* what, const std::string& unit,
                NoiseFigure NoiseFit::*figure, double factor, const char* data_sheet_unit) {
  std::string text = fmt::format("  {:<20}{:<18}", what, unit);
  for (const NoiseFit& fit : noise.axes) text += fmt::format("{:>22}", cell(fit.*figure));
  const NoiseFigure& all = noise.all.*figure;
  text += fmt::format("{:>22}", cell(all));
  return text + fmt::format("  {}{:.3g} {}\n", all.resolved ? "" : "< ",
                            factor * (all.resolved ? all.value : all.at_most), data_sheet_unit);
}

double statedWalk(const NoiseFit& fit) {
  return fit.walk.resolved ? fit.walk.value : fit.walkWithInstability(kWalkReference_s);
}

std::string walkComment(const char* key, const SensorNoise& noise) {
  return fmt::format("# {}: {}; with the bias instability ({:.4g} {}) in it as well: {:.4g}\n", key,
                     noise.all.walk.resolved ? "fitted random walk alone"
                                             : "no random walk was resolved; bias instability at 100 s",
                     noise.all.instability.value, noise.sensor.unit,
                     noise.all.walkWithInstability(kWalkReference_s));
}

std::string origin(const SensorNoise& noise) {
  return fmt::format("# Allan analysis of {:.2f} h at {:.2f} Hz at rest. Two-sided densities.\n",
                     noise.duration_s / 3600.0, noise.rate_hz);
}

nlohmann::ordered_json json(const NoiseFigure& figure) {
  return {{"value", figure.value},
          {"sigma", figure.sigma},
          {"at_most_95", figure.at_most},
          {"resolved", figure.resolved}};
}

nlohmann::ordered_json json(const NoiseFit& fit) {
  return {{"white_noise", json(fit.white)},
          {"bias_instability", json(fit.instability)},
          {"random_walk", json(fit.walk)},
          {"quantization", json(fit.quantization)},
          {"ramp_per_s", fit.ramp.value},
          {"white_noise_one_sided", std::numbers::sqrt2 * fit.white.value},
          {"flicker_corner_s", fit.flicker_corner_s},
          {"fitted_from_s", fit.shortest_s},
          {"fitted_to_s", fit.longest_s},
          {"misfit", fit.misfit}};
}

}  // namespace

std::string noiseTable(const std::vector<SensorNoise>& sensors) {
  std::string text;
  for (const SensorNoise& noise : sensors) {
    const std::string& unit = noise.sensor.unit;
    const DataSheetUnits sheet = dataSheetUnits(noise.sensor);
    text += fmt::format("{}: {:.3f} h at {:.2f} Hz, {} readings\n", noise.sensor.name,
                        noise.duration_s / 3600.0, noise.rate_hz, noise.readings - noise.repeated);
    text += fmt::format("  {:<38}{:>22}{:>22}{:>22}{:>22}\n", "", "x", "y", "z", "all axes");
    text += row(noise, "white noise N", unit + "/sqrtHz", &NoiseFit::white, sheet.white, sheet.white_unit);
    text += row(noise, "bias instability B", unit, &NoiseFit::instability, sheet.instability,
                sheet.instability_unit);
    text += row(noise, "random walk K", unit + "/s/sqrtHz", &NoiseFit::walk, sheet.walk, sheet.walk_unit);
    text += fmt::format("  fitted from {:.3g} to {:.4g} s, misfit {:.2g}\n\n", noise.all.shortest_s,
                        noise.all.longest_s, noise.all.misfit);
  }
  return text + kConventions;
}

nlohmann::ordered_json noiseJson(const std::vector<SensorNoise>& sensors) {
  nlohmann::ordered_json result;
  result["convention"] =
      "two-sided densities (Kalibr): sigma = density * sqrt(rate); one-sided are sqrt(2) larger";
  for (const SensorNoise& noise : sensors) {
    nlohmann::ordered_json sensor = {
        {"unit", noise.sensor.unit},      {"rate_hz", noise.rate_hz},
        {"duration_s", noise.duration_s}, {"readings", noise.readings},
        {"repeated", noise.repeated},     {"moved_share", noise.stillness.movedShare()},
        {"all", json(noise.all)}};
    for (size_t axis = 0; axis < 3; ++axis) sensor[std::string(1, "xyz"[axis])] = json(noise.axes[axis]);
    nlohmann::ordered_json curve = nlohmann::ordered_json::array();
    for (const AllanPoint& point : noise.curve.points) {
      const Vec3 deviation = point.deviation();
      curve.push_back({point.tau_s, deviation.x(), deviation.y(), deviation.z()});
    }
    sensor["allan_deviation"] = {{"columns", {"tau_s", "x", "y", "z"}}, {"rows", curve}};
    result["sensors"][noise.sensor.name] = sensor;
  }
  return result;
}

std::string kalibrImuYaml(const SensorNoise& gyroscope, const SensorNoise& accelerometer) {
  return origin(gyroscope) + walkComment("accelerometer_random_walk", accelerometer) +
         walkComment("gyroscope_random_walk", gyroscope) +
         fmt::format("accelerometer_noise_density: {:.6g}  # m/s^2/sqrt(Hz)\n",
                     accelerometer.all.white.value) +
         fmt::format("accelerometer_random_walk: {:.6g}  # m/s^3/sqrt(Hz)\n", statedWalk(accelerometer.all)) +
         fmt::format("gyroscope_noise_density: {:.6g}  # rad/s/sqrt(Hz)\n", gyroscope.all.white.value) +
         fmt::format("gyroscope_random_walk: {:.6g}  # rad/s^2/sqrt(Hz)\n", statedWalk(gyroscope.all)) +
         fmt::format("rostopic: /imu0\nupdate_rate: {:.6g}\n", gyroscope.rate_hz);
}

std::string magnetometerYaml(const SensorNoise& magnetometer) {
  const NoiseFit& fit = magnetometer.all;
  const auto comment = [](const char* what, const NoiseFigure& figure, const char* unit) {
    return fmt::format("# {}: {}{:.4g} {}\n", what, figure.resolved ? "" : "below ",
                       figure.resolved ? figure.value : figure.at_most, unit);
  };
  return origin(magnetometer) + comment("bias instability", fit.instability, "T") +
         comment("random walk", fit.walk, "T/s/sqrt(Hz)") +
         fmt::format("magnetometer_noise_density: {:.6g}  # T/sqrt(Hz)\n", fit.white.value) +
         fmt::format("rate_hz: {:.6g}\n", magnetometer.rate_hz);
}

}  // namespace lodeline
