#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "lodeline/rig.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

using Matrix = std::optional<Doubles>;

/// The rows of an array (N, 3).
std::vector<Vec3> rowsOf(const Doubles& array, const char* what) {
  return vectorsFrom(array, array.ndim() == 2 ? static_cast<size_t>(array.shape(0)) : 1, what);
}

void bindSonar(py::module_& module) {
  py::class_<SonarCalibration>(module, "Sonar", "A scanning sonar, or an altimeter.")
      .def(py::init([](const Matrix& body_from_sonar, double sigma_m, double beam_width_rad,
                       double max_range_m, double rate_hz) {
             SonarCalibration calibration;
             calibration.body_from_sonar = rigidOr(body_from_sonar, "body_from_sonar");
             calibration.range_noise_std_m = sigma_m;
             calibration.beam_width_rad = beam_width_rad;
             calibration.max_range_m = max_range_m;
             calibration.rate_hz = rate_hz;
             return calibration;
           }),
           py::kw_only(), py::arg("body_from_sonar") = py::none(),
           py::arg("range_sigma_m") = SonarCalibration().range_noise_std_m,
           py::arg("beam_width_rad") = SonarCalibration().beam_width_rad, py::arg("max_range_m") = 0.0,
           py::arg("rate_hz") = 0.0,
           "body_from_sonar: (4, 4); the head turns about its z axis, the beam of angle 0 points along x.\n"
           "range_sigma_m: noise of a range, m. max_range_m: greater ranges are no echoes; 0: unlimited.")
      .def_property_readonly(
          "body_from_sonar", [](const SonarCalibration& c) { return arrayOf(c.body_from_sonar); },
          "(4, 4), m")
      .def_readonly("range_sigma_m", &SonarCalibration::range_noise_std_m, "m")
      .def_readonly("beam_width_rad", &SonarCalibration::beam_width_rad, "rad, full")
      .def_readonly("max_range_m", &SonarCalibration::max_range_m, "m; 0: unlimited")
      .def_readonly("rate_hz", &SonarCalibration::rate_hz, "Hz");
}

void bindDvl(py::module_& module) {
  py::class_<DvlCalibration>(module, "Dvl",
                             "A Doppler velocity log. Its z axis is that of the beams, from the instrument "
                             "outwards.")
      .def(py::init([](const Matrix& body_from_dvl, const Matrix& beams, double velocity_sigma,
                       double range_sigma_m, double scale_sigma, double misalignment_sigma_rad,
                       double rate_hz, double time_offset_s) {
             DvlCalibration calibration;
             calibration.body_from_dvl = rigidOr(body_from_dvl, "body_from_dvl");
             if (beams) {
               calibration.beams_D = rowsOf(*beams, "beams");
               for (Vec3& beam : calibration.beams_D) {
                 if (!(beam.norm() > 0.0))
                   throw py::value_error("beams: directions are wanted, found (0, 0, 0)");
                 beam.normalize();
               }
             }
             calibration.velocity_noise_std_m_per_s = velocity_sigma;
             calibration.range_noise_std_m = range_sigma_m;
             calibration.scale_sigma = scale_sigma;
             calibration.misalignment_sigma_rad = misalignment_sigma_rad;
             calibration.rate_hz = rate_hz;
             calibration.time_offset_to_imu_s = time_offset_s;
             return calibration;
           }),
           py::kw_only(), py::arg("body_from_dvl") = py::none(), py::arg("beams") = py::none(),
           py::arg("velocity_sigma") = DvlCalibration().velocity_noise_std_m_per_s,
           py::arg("range_sigma_m") = DvlCalibration().range_noise_std_m,
           py::arg("scale_sigma") = DvlCalibration().scale_sigma,
           py::arg("misalignment_sigma_rad") = DvlCalibration().misalignment_sigma_rad,
           py::arg("rate_hz") = 0.0, py::arg("time_offset_s") = 0.0,
           "body_from_dvl: (4, 4). beams: (K, 3), directions in axes of the DVL; by default four at 22.5 "
           "degrees.\n"
           "velocity_sigma: noise of a ping, m/s. scale_sigma: of the speed of sound, relative.\n"
           "misalignment_sigma_rad: of body_from_dvl, each axis.")
      .def_property_readonly(
          "body_from_dvl", [](const DvlCalibration& c) { return arrayOf(c.body_from_dvl); }, "(4, 4), m")
      .def_property_readonly(
          "beams", [](const DvlCalibration& c) { return stack(c.beams_D, [](const Vec3& b) { return b; }); },
          "(K, 3), unit vectors")
      .def_readonly("velocity_sigma", &DvlCalibration::velocity_noise_std_m_per_s, "m/s")
      .def_readonly("range_sigma_m", &DvlCalibration::range_noise_std_m, "m")
      .def_readonly("scale_sigma", &DvlCalibration::scale_sigma, "relative")
      .def_readonly("misalignment_sigma_rad", &DvlCalibration::misalignment_sigma_rad, "rad")
      .def_readonly("rate_hz", &DvlCalibration::rate_hz, "Hz")
      .def_readonly("time_offset_s", &DvlCalibration::time_offset_to_imu_s, "added to the times of pings, s");
}

void bindCurrents(py::module_& module) {
  py::class_<CurrentCalibration>(module, "CurrentSensor",
                                 "Measured electric currents that disturb the magnetometer.")
      .def(py::init([](std::vector<std::string> channels, const Matrix& fields, double sigma, double rate_hz,
                       double time_offset_s) {
             CurrentCalibration calibration;
             calibration.channels = std::move(channels);
             if (fields)
               calibration.fields_T_per_A = vectorsFrom(*fields, calibration.channels.size(), "fields");
             calibration.field_sigma_T_per_A = sigma;
             calibration.rate_hz = rate_hz;
             calibration.time_offset_to_imu_s = time_offset_s;
             return calibration;
           }),
           py::kw_only(), py::arg("channels"), py::arg("fields") = py::none(), py::arg("field_sigma") = 0.0,
           py::arg("rate_hz") = 0.0, py::arg("time_offset_s") = 0.0,
           "channels: C names. fields: (C, 3), T/A in axes of the magnetometer's readings; without them they "
           "are\n"
           "estimated in the dive. field_sigma: of their components, T/A.")
      .def_readonly("channels", &CurrentCalibration::channels, "names")
      .def_property_readonly(
          "fields",
          [](const CurrentCalibration& c) {
            return stack(c.fields_T_per_A, [](const Vec3& k) { return k; });
          },
          "(C, 3), T/A; (0, 3) without calibration")
      .def_readonly("field_sigma", &CurrentCalibration::field_sigma_T_per_A, "T/A")
      .def_readonly("rate_hz", &CurrentCalibration::rate_hz, "Hz")
      .def_readonly("time_offset_s", &CurrentCalibration::time_offset_to_imu_s, "added to times, s");
}

}  // namespace

void bindRobotSensors(py::module_& module) {
  bindSonar(module);
  bindDvl(module);
  bindCurrents(module);
}

}  // namespace lodeline::python
