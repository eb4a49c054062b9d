#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/magnetometer/calibration/calibration_report.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/output/report/noise_report.h"
#include "lodeline/pipeline/calibration/analyse_noise.h"
#include "lodeline/util/json_text.h"
#include "python/src/arrays.h"
#include "python/src/bag_arguments.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

namespace fs = std::filesystem;

/// A magnetometer calibration and its findings.
struct CalibrationResult {
  MagnetometerCalibrationResult result;
  Diagnostics diagnostics;
};

CalibrationOptions optionsFor(const std::optional<std::array<double, 3>>& site,
                              const std::optional<std::string>& date) {
  CalibrationOptions options;
  if (site.has_value() != date.has_value())
    throw UsageError("site and date belong together: the Earth's field depends on both");
  if (site) {
    const GeodeticPosition position{(*site)[0], (*site)[1], (*site)[2]};
    options.site_field_ENU = worldMagneticField(position, decimalYear(*date)).field_ENU;
  }
  return options;
}

CalibrationResult calibrate(const MagnetometerRecord& record, const CalibrationOptions& options,
                            Diagnostics diagnostics) {
  CalibrationResult calibration{{}, std::move(diagnostics)};
  calibration.result = calibrateMagnetometer(record, options, &calibration.diagnostics);
  return calibration;
}

CalibrationResult calibrateRecording(const fs::path& data, const std::vector<fs::path>& rig,
                                     const std::map<std::string, std::string>& topics,
                                     const std::optional<std::string>& unit, double from_s,
                                     const std::optional<double>& to_s,
                                     const std::optional<std::array<double, 3>>& site,
                                     const std::optional<std::string>& date) {
  const CalibrationOptions options = optionsFor(site, date);
  RecordOptions part;
  part.from_s = from_s;
  part.to_s = to_s;
  if (unit) part.unit = fieldUnitFromString(*unit);
  if (unit && !part.unit) throw UsageError("unit '" + *unit + "': must be T, uT, nT, mG, G or raw");
  const BagArguments bag = bagArguments(rig, topics, false);
  return withoutGil([&] {
    Diagnostics diagnostics;
    const MagnetometerRecord record = readMagnetometerRecord(data, bag, part, &diagnostics);
    return calibrate(record, options, diagnostics);
  });
}

CalibrationResult calibrateReadings(py::handle times_ns, const Doubles& field_T,
                                    const std::optional<py::tuple>& imu, const ImuCalibration& imu_noise,
                                    const std::optional<std::array<double, 3>>& site,
                                    const std::optional<std::string>& date) {
  const CalibrationOptions options = optionsFor(site, date);
  MagnetometerRecord record;
  record.imu_noise = imu_noise.noise;
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<Vec3> fields = vectorsFrom(field_T, times.size(), "field_T");
  for (size_t i = 0; i < times.size(); ++i) record.magnetometer.push_back({times[i], fields[i]});
  if (imu) {
    if (imu->size() != 3)
      throw py::value_error("imu: (times_ns, angular_velocity, specific_force) is wanted");
    const std::vector<Time> imu_times = timesFrom((*imu)[0]);
    const auto rates = vectorsFrom((*imu)[1].cast<Doubles>(), imu_times.size(), "angular_velocity");
    const auto forces = vectorsFrom((*imu)[2].cast<Doubles>(), imu_times.size(), "specific_force");
    for (size_t i = 0; i < imu_times.size(); ++i)
      record.imu.push_back(ImuSample{imu_times[i], rates[i], forces[i], 0.0});
  }
  return withoutGil([&] { return calibrate(record, options, {}); });
}

void bindMagnetometerResult(py::module_& module) {
  using Type = const CalibrationResult&;
  py::class_<CalibrationResult>(
      module, "MagnetometerCalibration",
      "Soft and hard iron of a magnetometer. The field is iron_correction @ (reading - hard_iron).")
      .def_property_readonly(
          "iron_correction", [](Type c) { return c.result.fit.iron_correction; }, "(3, 3), symmetric")
      .def_property_readonly(
          "hard_iron", [](Type c) { return c.result.fit.hard_iron; },
          "(3), unit of the readings: T or counts")
      .def_property_readonly(
          "body_from_magnetometer",
          [](Type c) -> std::optional<Mat3> {
            const auto& rotation = c.result.fit.body_from_magnetometer;
            return rotation ? std::optional<Mat3>(rotation->toRotationMatrix()) : std::nullopt;
          },
          "(3, 3) rotation, where it could be estimated; or None")
      .def_property_readonly(
          "time_offset_s", [](Type c) { return c.result.fit.time_offset_to_imu_s; },
          "added to magnetometer times to obtain the IMU's clock, s; or None")
      .def_property_readonly("field_strength_T", [](Type c) { return c.result.fit.field_strength_T; })
      .def_property_readonly(
          "covariance", [](Type c) { return c.result.fit.covariance; },
          "(12, 12), of [A xx yy zz xy xz yz, hard iron x y z, rotation x y z (rad, body axes)]")
      .def_property_readonly(
          "heading_error_rad", [](Type c) { return c.result.fit.heading_error_rad; }, "one sigma")
      .def_property_readonly("verdict", [](Type c) { return c.result.fit.verdict; })
      .def_property_readonly(
          "figures", [](Type c) { return fromJson(jsonText(calibrationJson(c.result))); },
          "all figures as `lodeline calibrate magnetometer --json` writes them")
      .def_property_readonly("findings", [](Type c) { return findingsOf(c.diagnostics); })
      .def(
          "corrected",
          [](Type c, const Doubles& readings) {
            const auto count = readings.ndim() > 0 ? static_cast<size_t>(readings.shape(0)) : 0;
            const std::vector<Vec3> vectors = vectorsFrom(readings, count, "readings");
            return stack(vectors, [&](const Vec3& reading) { return c.result.fit.corrected_M(reading); });
          },
          py::arg("readings"), "The field (N, 3), T, of readings (N, 3), axes of the magnetometer.")
      .def(
          "write", [](Type c, const fs::path& file) { writeCalibrationFile(c.result.fit, file); },
          py::arg("file"), "Writes the file for run(magnetometer_calibration=...).")
      .def("__str__", [](Type c) { return printable(calibrationText(c.result)); });
}

/// Noise of the sensors of a record.
struct NoiseResult {
  std::vector<SensorNoise> sensors;
  Diagnostics diagnostics;
};

void bindNoise(py::module_& module) {
  py::class_<SensorNoise>(module, "SensorNoise", "Noise of a sensor at rest; K averaging times.")
      .def_property_readonly("name", [](const SensorNoise& n) { return n.sensor.name; })
      .def_property_readonly(
          "unit", [](const SensorNoise& n) { return n.sensor.unit; }, "of the readings")
      .def_readonly("rate_hz", &SensorNoise::rate_hz, "Hz")
      .def_readonly("duration_s", &SensorNoise::duration_s, "s")
      .def_property_readonly(
          "taus_s",
          [](const SensorNoise& n) {
            return column<double>(n.curve.points, [](const AllanPoint& p) { return p.tau_s; });
          },
          "(K), averaging times, s")
      .def_property_readonly(
          "deviations",
          [](const SensorNoise& n) {
            return stack(n.curve.points, [](const AllanPoint& p) -> Vec3 { return p.deviation(); });
          },
          "(K, 3), Allan deviation of x, y, z, unit of the readings")
      .def_property_readonly(
          "white_noise", [](const SensorNoise& n) { return n.all.white.value; },
          "of all axes, two-sided density, unit/sqrt(Hz)")
      .def_property_readonly(
          "bias_instability", [](const SensorNoise& n) { return n.all.instability.value; },
          "of all axes, unit")
      .def_property_readonly(
          "random_walk", [](const SensorNoise& n) { return n.all.walk.value; },
          "of all axes, two-sided density, unit/s/sqrt(Hz); 0 where it is not resolved")
      .def_property_readonly(
          "figures",
          [](const SensorNoise& n) { return fromJson(jsonText(noiseJson({n})["sensors"][n.sensor.name])); },
          "all figures with their sigmas, as `lodeline allan --json` writes them");
  module.def(
      "allan",
      [](const fs::path& data, const std::vector<fs::path>& rig,
         const std::map<std::string, std::string>& topics, double skip_s, double duration_s) {
        const NoiseRequest request{data.string(), bagArguments(rig, topics, false), skip_s, duration_s};
        Diagnostics diagnostics;
        const auto sensors = withoutGil([&] { return analyseNoise(request, &diagnostics); });
        warn(diagnostics);
        py::dict result;
        for (const SensorNoise& noise : sensors) result[py::str(noise.sensor.name)] = noise;
        return result;
      },
      py::arg("data"), py::kw_only(), py::arg("rig") = std::vector<fs::path>(),
      py::arg("topics") = std::map<std::string, std::string>(), py::arg("skip_s") = 0.0,
      py::arg("duration_s") = 0.0,
      "Noise of gyroscope, accelerometer and magnetometer from a record at rest: a SensorNoise for each by "
      "its\n"
      "name. data: folder, bag or table of readings. skip_s, duration_s: part to use, s; 0 for all.");
  module.def(
      "allan_of",
      [](const std::string& sensor, py::handle times_ns, const Doubles& readings) {
        const std::vector<Time> times = timesFrom(times_ns);
        const std::vector<Vec3> vectors = vectorsFrom(readings, times.size(), "readings");
        std::optional<AnalysedSensor> analysed;
        for (AnalysedSensor known :
             {gyroscopeToAnalyse(), accelerometerToAnalyse(), magnetometerToAnalyse()}) {
          if (known.name == sensor) analysed = known;
        }
        if (!analysed)
          throw UsageError("sensor '" + sensor + "': must be gyroscope, accelerometer or magnetometer");
        Diagnostics diagnostics;
        SensorNoise noise = withoutGil([&] {
          SensorNoiseAnalysis analysis(*analysed, &diagnostics);
          for (size_t i = 0; i < times.size(); ++i) analysis.add(times[i], vectors[i]);
          return analysis.finish();
        });
        warn(diagnostics);
        return noise;
      },
      py::arg("sensor"), py::arg("times_ns"), py::arg("readings"),
      "Noise of one sensor at rest. sensor: gyroscope (rad/s), accelerometer (m/s^2) or magnetometer (T).\n"
      "times_ns: (N) int64, ns. readings: (N, 3).");
}

}  // namespace

void bindCalibration(py::module_& module) {
  bindMagnetometerResult(module);
  module.def(
      "calibrate_magnetometer", &calibrateRecording, py::arg("data"), py::kw_only(),
      py::arg("rig") = std::vector<fs::path>(), py::arg("topics") = std::map<std::string, std::string>(),
      py::arg("unit") = py::none(), py::arg("from_s") = 0.0, py::arg("to_s") = py::none(),
      py::arg("site") = py::none(), py::arg("date") = py::none(),
      "Calibrates a magnetometer from a recording of a rig that was turned about: folder, bag or table.\n\n"
      "unit: of a table without one: T, uT, nT, mG, G or raw. from_s, to_s: part to use, s.\n"
      "site: (latitude, longitude in degrees, height in m) and date: YYYY-MM-DD give the field's strength.\n"
      "Raises EstimationError where the readings cannot calibrate the magnetometer.");
  module.def(
      "calibrate_magnetometer_readings", &calibrateReadings, py::arg("times_ns"), py::arg("field_T"),
      py::kw_only(), py::arg("imu") = py::none(), py::arg_v("imu_noise", ImuCalibration{0.0, {}}, "Imu()"),
      py::arg("site") = py::none(), py::arg("date") = py::none(),
      "The same from arrays. times_ns: (N) int64, ns. field_T: (N, 3), T. imu: (times_ns (K),\n"
      "angular_velocity (K, 3) rad/s, specific_force (K, 3) m/s^2), for the rotation and the time offset.");
  bindNoise(module);
}

}  // namespace lodeline::python
