#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "lodeline/rig.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

using Matrix = std::optional<Doubles>;

void bindImu(py::module_& module) {
  py::class_<ImuCalibration>(module, "Imu",
                             "The IMU, which defines the body frame B. Densities are two-sided.")
      .def(py::init([](double rate_hz, double gyroscope, double gyroscope_walk, double accelerometer,
                       double accelerometer_walk) {
             return ImuCalibration{
                 rate_hz, {gyroscope, gyroscope_walk, accelerometer, accelerometer_walk, std::nullopt}};
           }),
           py::kw_only(), py::arg("rate_hz") = 0.0,
           py::arg("gyroscope_density") = ImuNoise().gyroscope_density_rad_per_s_sqrtHz,
           py::arg("gyroscope_random_walk") = ImuNoise().gyroscope_random_walk_rad_per_s2_sqrtHz,
           py::arg("accelerometer_density") = ImuNoise().accelerometer_density_m_per_s2_sqrtHz,
           py::arg("accelerometer_random_walk") = ImuNoise().accelerometer_random_walk_m_per_s3_sqrtHz,
           "rate_hz 0: measured from the readings.")
      .def_readonly("rate_hz", &ImuCalibration::rate_hz, "Hz")
      .def_property_readonly(
          "gyroscope_density",
          [](const ImuCalibration& c) { return c.noise.gyroscope_density_rad_per_s_sqrtHz; },
          "rad/s/sqrt(Hz)")
      .def_property_readonly(
          "gyroscope_random_walk",
          [](const ImuCalibration& c) { return c.noise.gyroscope_random_walk_rad_per_s2_sqrtHz; },
          "rad/s^2/sqrt(Hz)")
      .def_property_readonly(
          "accelerometer_density",
          [](const ImuCalibration& c) { return c.noise.accelerometer_density_m_per_s2_sqrtHz; },
          "m/s^2/sqrt(Hz)")
      .def_property_readonly(
          "accelerometer_random_walk",
          [](const ImuCalibration& c) { return c.noise.accelerometer_random_walk_m_per_s3_sqrtHz; },
          "m/s^3/sqrt(Hz)");
}

void bindCamera(py::module_& module) {
  py::class_<CameraCalibration>(module, "Camera", "A camera; docs/reference/file-formats.md has the models.")
      .def(py::init([](const std::array<int, 2>& size_px, const std::array<double, 4>& intrinsics_px,
                       const std::string& model, const std::vector<double>& distortion,
                       const Matrix& body_from_camera, double rate_hz, double time_offset_s,
                       const std::string& name) {
             CameraCalibration camera;
             camera.name = name;
             camera.width_px = size_px[0];
             camera.height_px = size_px[1];
             camera.fx_px = intrinsics_px[0];
             camera.fy_px = intrinsics_px[1];
             camera.cx_px = intrinsics_px[2];
             camera.cy_px = intrinsics_px[3];
             camera.model = model;
             camera.distortion = distortion;
             camera.body_from_camera = rigidOr(body_from_camera, "body_from_camera");
             camera.rate_hz = rate_hz;
             camera.time_offset_to_imu_s = time_offset_s;
             return camera;
           }),
           py::kw_only(), py::arg("size_px"), py::arg("intrinsics_px"), py::arg("model") = "none",
           py::arg("distortion") = std::vector<double>(), py::arg("body_from_camera") = py::none(),
           py::arg("rate_hz") = 0.0, py::arg("time_offset_s") = 0.0, py::arg("name") = "",
           "size_px: (width, height). intrinsics_px: (fx, fy, cx, cy), pixel centres at integers.\n"
           "body_from_camera: (4, 4). rate_hz 0: measured. time_offset_s is added to image times to obtain\n"
           "the IMU's clock.")
      .def_readonly("name", &CameraCalibration::name)
      .def_property_readonly(
          "size_px", [](const CameraCalibration& c) { return py::make_tuple(c.width_px, c.height_px); },
          "(width, height)")
      .def_property_readonly(
          "intrinsics_px",
          [](const CameraCalibration& c) { return py::make_tuple(c.fx_px, c.fy_px, c.cx_px, c.cy_px); },
          "(fx, fy, cx, cy)")
      .def_readonly("model", &CameraCalibration::model, "name of the camera model")
      .def_readonly("distortion", &CameraCalibration::distortion,
                    "parameters of the model after fx, fy, cx, cy")
      .def_property_readonly(
          "body_from_camera", [](const CameraCalibration& c) { return arrayOf(c.body_from_camera); },
          "(4, 4), m")
      .def_readonly("rate_hz", &CameraCalibration::rate_hz, "Hz")
      .def_readonly("time_offset_s", &CameraCalibration::time_offset_to_imu_s, "added to image times, s");
}

void bindOtherSensors(py::module_& module) {
  py::class_<MagnetometerCalibration>(
      module, "Magnetometer",
      "A magnetometer. The field in its frame is iron_correction @ (reading - "
      "hard_iron_T).")
      .def(py::init([](const Matrix& body_from_magnetometer, const std::optional<Mat3>& iron_correction,
                       const std::optional<Vec3>& hard_iron_T, double density, double rate_hz,
                       double time_offset_s) {
             MagnetometerCalibration calibration;
             calibration.rate_hz = rate_hz;
             calibration.noise_density_T_per_sqrtHz = density;
             calibration.body_from_magnetometer = rigidOr(body_from_magnetometer, "body_from_magnetometer");
             calibration.is_calibrated = iron_correction.has_value();
             calibration.iron_correction = iron_correction.value_or(Mat3::Identity());
             calibration.hard_iron_T = hard_iron_T.value_or(Vec3::Zero());
             calibration.time_offset_to_imu_s = time_offset_s;
             return calibration;
           }),
           py::kw_only(), py::arg("body_from_magnetometer") = py::none(),
           py::arg("iron_correction") = py::none(), py::arg("hard_iron_T") = py::none(),
           py::arg("noise_density_T") = 1e-8, py::arg("rate_hz") = 0.0, py::arg("time_offset_s") = 0.0,
           "body_from_magnetometer: (4, 4). iron_correction: (3, 3), symmetric; without it the magnetometer\n"
           "is not calibrated. noise_density_T: T/sqrt(Hz).")
      .def_property_readonly(
          "body_from_magnetometer",
          [](const MagnetometerCalibration& c) { return arrayOf(c.body_from_magnetometer); }, "(4, 4), m")
      .def_readonly("iron_correction", &MagnetometerCalibration::iron_correction, "(3, 3)")
      .def_readonly("hard_iron_T", &MagnetometerCalibration::hard_iron_T, "(3), T")
      .def_readonly("is_calibrated", &MagnetometerCalibration::is_calibrated)
      .def_readonly("rate_hz", &MagnetometerCalibration::rate_hz, "Hz");
  py::class_<PressureCalibration>(module, "PressureSensor", "A pressure sensor.")
      .def(py::init([](double sigma_m, const Matrix& body_from_pressure, double rate_hz) {
             return PressureCalibration{rate_hz, sigma_m, rigidOr(body_from_pressure, "body_from_pressure")};
           }),
           py::kw_only(), py::arg("depth_sigma_m") = 0.02, py::arg("body_from_pressure") = py::none(),
           py::arg("rate_hz") = 0.0, "depth_sigma_m: noise of a reading, m. body_from_pressure: (4, 4).")
      .def_readonly("depth_sigma_m", &PressureCalibration::depth_noise_std_m, "m")
      .def_property_readonly(
          "body_from_pressure", [](const PressureCalibration& c) { return arrayOf(c.body_from_pressure); },
          "(4, 4), m")
      .def_readonly("rate_hz", &PressureCalibration::rate_hz, "Hz");
}

}  // namespace

void bindRig(py::module_& module) {
  bindImu(module);
  bindCamera(module);
  bindOtherSensors(module);
  bindRobotSensors(module);
  py::class_<DescribedRig>(module, "Rig", "All rigidly connected sensors with their extrinsics.")
      .def(py::init([](std::vector<CameraCalibration> cameras, const ImuCalibration& imu,
                       const std::optional<MagnetometerCalibration>& magnetometer,
                       const std::optional<PressureCalibration>& pressure,
                       const std::optional<SonarCalibration>& sonar,
                       const std::optional<SonarCalibration>& altimeter,
                       const std::optional<DvlCalibration>& dvl,
                       const std::optional<CurrentCalibration>& currents) {
             for (size_t i = 0; i < cameras.size(); ++i) {
               if (cameras[i].name.empty()) cameras[i].name = "cam" + std::to_string(i);
             }
             DescribedRig described;
             described.rig.imu = imu;
             described.rig.cameras = std::move(cameras);
             described.rig.magnetometer = magnetometer;
             described.rig.pressure = pressure;
             described.rig.sonar = sonar;
             described.rig.altimeter = altimeter;
             described.rig.dvl = dvl;
             described.rig.currents = currents;
             return described;
           }),
           py::kw_only(), py::arg("cameras"), py::arg_v("imu", ImuCalibration{0.0, {}}, "Imu()"),
           py::arg("magnetometer") = py::none(), py::arg("pressure") = py::none(),
           py::arg("sonar") = py::none(), py::arg("altimeter") = py::none(), py::arg("dvl") = py::none(),
           py::arg("currents") = py::none())
      .def_property_readonly("cameras",
                             [](const DescribedRig& d) { return py::tuple(py::cast(d.rig.cameras)); })
      .def_property_readonly("imu", [](const DescribedRig& d) { return d.rig.imu; })
      .def_property_readonly("magnetometer", [](const DescribedRig& d) { return d.rig.magnetometer; })
      .def_property_readonly("pressure", [](const DescribedRig& d) { return d.rig.pressure; })
      .def_property_readonly("sonar", [](const DescribedRig& d) { return d.rig.sonar; })
      .def_property_readonly(
          "altimeter", [](const DescribedRig& d) { return d.rig.altimeter; },
          "a Sonar whose beam points along x")
      .def_property_readonly("dvl", [](const DescribedRig& d) { return d.rig.dvl; })
      .def_property_readonly("currents", [](const DescribedRig& d) { return d.rig.currents; })
      .def_property_readonly("has_sonar", [](const DescribedRig& d) { return d.rig.sonar.has_value(); })
      .def_property_readonly("has_altimeter",
                             [](const DescribedRig& d) { return d.rig.altimeter.has_value(); })
      .def_property_readonly("has_dvl", [](const DescribedRig& d) { return d.rig.dvl.has_value(); })
      .def_property_readonly(
          "current_channels",
          [](const DescribedRig& d) { return d.rig.currents.value_or(CurrentCalibration()).channels; },
          "Names of the channels of current0.")
      .def_property_readonly(
          "has_imu_correction", [](const DescribedRig& d) { return d.imu_correction.has_value(); },
          "whether the files state scale, misalignment or biases of the IMU, which are then applied");
  module.def(
      "read_rig",
      [](const std::vector<std::filesystem::path>& files) {
        Diagnostics diagnostics;
        DescribedRig rig = readRig(files, &diagnostics);
        warn(diagnostics);
        return rig;
      },
      py::arg("files"),
      "Reads files that together describe a rig: rig.yaml, or files of EuRoC, Kalibr, OpenVINS and others.");
}

}  // namespace lodeline::python
