#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "lodeline/io/calibration/rig_file.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/feed.h"
#include "python/src/robot_readings.h"

namespace lodeline::python {
namespace {

using Pixels = py::array_t<uint8_t, py::array::c_style>;

void checkSignals() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

std::unique_ptr<Feed> makeFeed(const DescribedRig& rig, const py::dict& settings,
                               const std::optional<std::filesystem::path>& config, double patience_s) {
  OdometrySettings all;
  if (config) all.load(*config);
  for (const auto& [key, value] : settings) all.set(py::str(key).cast<std::string>(), yamlText(value));
  if (!(patience_s > 0.0)) throw UsageError("patience_s: must be positive");
  return std::make_unique<Feed>(rig, std::move(all), patience_s);
}

void pushImu(Feed& feed, py::handle times_ns, const Doubles& angular_velocity,
             const Doubles& specific_force) {
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<Vec3> rates = vectorsFrom(angular_velocity, times.size(), "angular_velocity");
  const std::vector<Vec3> forces = vectorsFrom(specific_force, times.size(), "specific_force");
  withoutGil([&] {
    for (size_t i = 0; i < times.size(); ++i) feed.push(ImuSample{times[i], rates[i], forces[i], 0.0});
  });
}

void pushMagnetometer(Feed& feed, py::handle times_ns, const Doubles& field_T) {
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<Vec3> fields = vectorsFrom(field_T, times.size(), "field_T");
  withoutGil([&] {
    for (size_t i = 0; i < times.size(); ++i) feed.push(MagnetometerSample{times[i], fields[i]});
  });
}

void pushDepth(Feed& feed, py::handle times_ns, const Doubles& depth_m) {
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<double> depths = numbersFrom(depth_m, times.size(), "depth_m");
  withoutGil([&] {
    for (size_t i = 0; i < times.size(); ++i) feed.push(DepthSample{times[i], depths[i]});
  });
}

void pushPressure(Feed& feed, py::handle times_ns, const Doubles& pressure_Pa, double density_kg_per_m3,
                  double surface_pressure_Pa) {
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<double> pressures = numbersFrom(pressure_Pa, times.size(), "pressure_Pa");
  const WaterColumn water{density_kg_per_m3, surface_pressure_Pa};
  withoutGil([&] {
    for (size_t i = 0; i < times.size(); ++i) feed.push(DepthSample{times[i], water.depth_m(pressures[i])});
  });
}

void pushSonar(Feed& feed, py::handle times_ns, const Doubles& range_m, const Doubles& angle_rad) {
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<double> ranges = numbersFrom(range_m, times.size(), "range_m");
  const std::vector<double> angles = numbersFrom(angle_rad, times.size(), "angle_rad");
  withoutGil([&] {
    for (size_t i = 0; i < times.size(); ++i) feed.push(SonarSample{times[i], ranges[i], angles[i]});
  });
}

void pushAltimeter(Feed& feed, py::handle times_ns, const Doubles& range_m) {
  const std::vector<Time> times = timesFrom(times_ns);
  const std::vector<double> ranges = numbersFrom(range_m, times.size(), "range_m");
  withoutGil([&] {
    for (size_t i = 0; i < times.size(); ++i) feed.push(AltimeterSample{times[i], ranges[i]});
  });
}

void pushDvl(Feed& feed, py::handle times_ns, const OptionalDoubles& velocity, const OptionalDoubles& sigma,
             py::handle is_water_track, const OptionalDoubles& beam_velocity,
             const OptionalDoubles& beam_range) {
  const std::vector<DvlSample> pings =
      pingsFrom(timesFrom(times_ns), velocity, sigma, is_water_track, beam_velocity, beam_range);
  withoutGil([&] {
    for (const DvlSample& ping : pings) feed.push(ping);
  });
}

void pushCurrents(Feed& feed, py::handle times_ns, const py::dict& currents) {
  const std::vector<CurrentSample> samples =
      currentsFrom(timesFrom(times_ns), currents, feed.currentChannels());
  withoutGil([&] {
    for (const CurrentSample& sample : samples) feed.push(sample);
  });
}

void pushImage(Feed& feed, size_t camera, py::handle time_ns, const py::array& image) {
  const std::vector<Time> times = timesFrom(time_ns);
  if (times.size() != 1) throw py::value_error("time_ns: one integer is wanted");
  if (!py::isinstance<Pixels>(image) && image.dtype().kind() + std::to_string(image.itemsize()) != "u1")
    throw py::type_error("image: an array of type uint8 is wanted");
  if (image.ndim() != 2) throw py::value_error("image: wanted shape (height, width), grey");
  const Pixels pixels = Pixels::ensure(image);
  // The caller may change the array afterwards.
  const cv::Mat copy = cv::Mat(static_cast<int>(pixels.shape(0)), static_cast<int>(pixels.shape(1)), CV_8UC1,
                               const_cast<uint8_t*>(pixels.data()))
                           .clone();
  while (!withoutGil([&] { return feed.push(camera, times.front(), copy); })) checkSignals();
}

EstimateTable finish(Feed& feed) {
  withoutGil([&] { feed.close(); });
  while (!withoutGil([&] { return feed.waitForEnd(); })) checkSignals();
  return feed.estimates();
}

}  // namespace

void bindOdometry(py::module_& module) {
  py::class_<Feed>(module, "Odometry",
                   "Odometry on readings pushed by hand, which a second thread estimates from. Push readings "
                   "in the order\n"
                   "of their times, over all sensors. Waits where it is slower than the images.")
      .def(py::init(&makeFeed), py::arg("rig"), py::kw_only(), py::arg("settings") = py::dict(),
           py::arg("config") = py::none(), py::arg("patience_s") = 1.0,
           "settings: values by the keys of docs/reference/settings.md, over those of the file config.\n"
           "patience_s: how much later than inertial readings of the same time others may be pushed.")
      .def("push_imu", &pushImu, py::arg("times_ns"), py::arg("angular_velocity"), py::arg("specific_force"),
           "times_ns: int or (N) int64, ns. angular_velocity: (3) or (N, 3), rad/s. specific_force: the "
           "same,\n"
           "m/s^2, +9.8 along up at rest. Body axes.")
      .def("push_magnetometer", &pushMagnetometer, py::arg("times_ns"), py::arg("field_T"),
           "field_T: (3) or (N, 3), T, axes of the magnetometer, not corrected.")
      .def("push_depth", &pushDepth, py::arg("times_ns"), py::arg("depth_m"),
           "depth_m: number or (N), m, positive down.")
      .def("push_pressure", &pushPressure, py::arg("times_ns"), py::arg("pressure_Pa"), py::kw_only(),
           py::arg("density_kg_per_m3") = WaterColumn().density_kg_per_m3,
           py::arg("surface_pressure_Pa") = WaterColumn().surface_pressure_Pa,
           "pressure_Pa: number or (N), absolute, Pa.")
      .def("push_sonar", &pushSonar, py::arg("times_ns"), py::arg("range_m"), py::arg("angle_rad"),
           "range_m: number or (N), m. angle_rad: the same, rad, of the beam about the z axis of the sonar's "
           "head,\n"
           "0 along x.")
      .def("push_altimeter", &pushAltimeter, py::arg("times_ns"), py::arg("range_m"),
           "range_m: number or (N), m, along the altimeter's x axis.")
      .def("push_dvl", &pushDvl, py::arg("times_ns"), py::arg("velocity") = py::none(),
           py::arg("sigma") = py::none(), py::arg("is_water_track") = py::none(), py::kw_only(),
           py::arg("beam_velocity") = py::none(), py::arg("beam_range") = py::none(),
           "velocity: (3) or (N, 3), m/s, of the instrument, axes of the DVL. sigma: number or (N), m/s, of "
           "each\n"
           "axis. is_water_track: bool or (N), False by default. beam_velocity: (K) or (N, K), m/s, along "
           "the K\n"
           "beams in the order of the rig, positive from the instrument outwards. beam_range: the same, m. "
           "NaN where\n"
           "there is no lock. Where a ping has velocities of beams, these count and its velocity does not.")
      .def("push_currents", &pushCurrents, py::arg("times_ns"), py::arg("currents"),
           "currents: dict of number or (N), A, by the names of all channels of the rig.")
      .def("push_image", &pushImage, py::arg("camera"), py::arg("time_ns"), py::arg("image"),
           "camera: index. time_ns: mid-exposure, ns. image: (height, width) uint8, grey.")
      .def(
          "take", [](Feed& feed) { return withoutGil([&] { return feed.take(); }); },
          "Takes the list of estimates that are ready; does not wait.")
      .def("finish", &finish, "Ends the readings, waits for the last estimate and returns all Estimates.")
      .def_property_readonly(
          "findings", [](Feed& feed) { return findingsOf(feed.findings()); }, "after finish()");
}

}  // namespace lodeline::python
