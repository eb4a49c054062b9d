#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "python/src/arrays.h"
#include "python/src/bindings.h"
#include "python/src/estimate_table.h"

namespace lodeline::python {
namespace {

using Row = EstimateTable::Row;

py::dict sensorsOf(const FrameEstimate& estimate) {
  py::dict sensors;
  for (const SensorRow& row : estimate.sensor_rows) {
    py::dict columns;
    columns["status"] = row.status;
    for (const auto& [name, value] : row.columns) columns[py::str(name)] = value;
    sensors[py::str(row.sensor)] = columns;
  }
  return sensors;
}

py::array names(const EstimateTable& table, const char* (*name)(const Row&)) {
  py::list list;
  for (const Row& row : table.rows) list.append(name(row));
  return py::module_::import("numpy").attr("array")(list, py::arg("dtype") = "U16");
}

void bindEstimate(py::module_& module) {
  using Type = const FrameEstimate&;
  py::class_<FrameEstimate>(
      module, "Estimate",
      "What is known right after a frame was added. World W: z up. Body B: the IMU. Without a pose (status\n"
      "'waiting'), the numbers are zero.")
      .def_property_readonly(
          "time_ns", [](Type e) { return e.time.nanoseconds(); }, "ns, on the clock of the IMU")
      .def_property_readonly(
          "status", [](Type e) { return toString(e.status); }, "waiting, tracking, degraded or inertial")
      .def_property_readonly(
          "mode", [](Type e) { return toString(e.mode); }, "what the estimator does")
      .def_readonly("waiting_for", &FrameEstimate::waiting_for, "in words, while waiting")
      .def_property_readonly("has_pose", [](Type e) { return e.status != Status::Waiting; })
      .def_property_readonly(
          "pose", [](Type e) { return arrayOf(e.state.world_from_body); }, "(4, 4), world_from_body, m")
      .def_property_readonly(
          "position", [](Type e) { return e.state.world_from_body.translation; }, "(3), m")
      .def_property_readonly(
          "quaternion", [](Type e) { return quaternionOf(e.state.world_from_body.rotation); },
          "(4), [w, x, y, z], world_from_body")
      .def_property_readonly(
          "velocity", [](Type e) { return e.state.velocity_W; }, "(3), m/s, world axes")
      .def_property_readonly(
          "gyroscope_bias", [](Type e) { return e.state.gyroscope_bias_B; }, "(3), rad/s")
      .def_property_readonly(
          "accelerometer_bias", [](Type e) { return e.state.accelerometer_bias_B; }, "(3), m/s^2")
      .def_property_readonly(
          "covariance", [](Type e) { return e.covariance; },
          "(15, 15), of [dp, dtheta, dv, db_g, db_a] in world axes: m, rad, m/s, rad/s, m/s^2")
      .def_property_readonly(
          "pose_covariance", [](Type e) -> Mat6 { return e.covariance.topLeftCorner<6, 6>(); },
          "(6, 6), of [dp, dtheta] in world axes: m, rad")
      .def_readonly("is_keyframe", &FrameEstimate::is_keyframe)
      .def_readonly("tracks", &FrameEstimate::tracks, "points seen in the frame")
      .def_readonly("landmarks", &FrameEstimate::landmarks, "tracks that have a position")
      .def_readonly("reprojection_rms", &FrameEstimate::reprojection_rms_sigmas,
                    "in sigmas of an observation")
      .def_readonly("scene_distance_m", &FrameEstimate::scene_distance_m, "harmonic mean, m; or None")
      .def_property_readonly(
          "magnetometer", [](Type e) { return toString(e.sensors.of<MagnetometerEstimate>().status); },
          "off, no_data, used or why it was rejected")
      .def_property_readonly(
          "heading_sigma", [](Type e) { return e.sensors.of<MagnetometerEstimate>().heading_sigma_rad; },
          "rad")
      .def_property_readonly(
          "north_from_world",
          [](Type e) { return e.sensors.of<MagnetometerEstimate>().north_from_world_rad; },
          "rad about the vertical; None while north is unknown")
      .def_property_readonly(
          "pressure", [](Type e) { return toString(e.sensors.of<DepthEstimate>().status); },
          "off, no_data, used or why it was rejected")
      .def_property_readonly(
          "depth_m",
          [](Type e) -> std::optional<double> {
            const auto& gauge = e.sensors.of<DepthEstimate>().gauge;
            return gauge ? std::optional(gauge->body_depth_m) : std::nullopt;
          },
          "of the body below the surface, m; or None")
      .def_property_readonly("sensors", &sensorsOf,
                             "further sensors: by name a dict with the status and the columns of states.csv");
}

}  // namespace

void bindEstimates(py::module_& module) {
  bindEstimate(module);
  using Type = const EstimateTable&;
  py::class_<EstimateTable>(module, "Estimates",
                            "Estimates of N frames with a pose, and M landmarks, as arrays. World W: z up, y "
                            "to north where north is\n"
                            "known; body B: the IMU.")
      .def("__len__", [](Type t) { return t.rows.size(); })
      .def_property_readonly(
          "times_ns", [](Type t) { return timeColumn(t.rows, [](const Row& r) { return r.state.time; }); },
          "(N) int64, ns, on the clock of the IMU")
      .def_property_readonly(
          "poses",
          [](Type t) { return stack(t.rows, [](const Row& r) { return r.state.world_from_body.matrix(); }); },
          "(N, 4, 4), world_from_body, m")
      .def_property_readonly(
          "positions",
          [](Type t) {
            return stack(t.rows, [](const Row& r) { return r.state.world_from_body.translation; });
          },
          "(N, 3), m")
      .def_property_readonly(
          "quaternions",
          [](Type t) {
            return stack(t.rows, [](const Row& r) { return quaternionOf(r.state.world_from_body.rotation); });
          },
          "(N, 4), [w, x, y, z], world_from_body")
      .def_property_readonly(
          "velocities", [](Type t) { return stack(t.rows, [](const Row& r) { return r.state.velocity_W; }); },
          "(N, 3), m/s, world axes")
      .def_property_readonly(
          "gyroscope_biases",
          [](Type t) { return stack(t.rows, [](const Row& r) { return r.state.gyroscope_bias_B; }); },
          "(N, 3), rad/s, body axes")
      .def_property_readonly(
          "accelerometer_biases",
          [](Type t) { return stack(t.rows, [](const Row& r) { return r.state.accelerometer_bias_B; }); },
          "(N, 3), m/s^2, body axes")
      .def_property_readonly(
          "pose_covariances",
          [](Type t) { return stack(t.rows, [](const Row& r) { return r.pose_covariance; }); },
          "(N, 6, 6), of [dp, dtheta] in world axes: m, rad")
      .def_property_readonly(
          "velocity_sigmas",
          [](Type t) { return stack(t.rows, [](const Row& r) { return r.velocity_sigma; }); }, "(N, 3), m/s")
      .def_property_readonly(
          "heading_sigmas",
          [](Type t) { return column<double>(t.rows, [](const Row& r) { return r.heading_sigma_rad; }); },
          "(N), rad")
      .def_property_readonly(
          "depths_m", [](Type t) { return column<double>(t.rows, [](const Row& r) { return r.depth_m; }); },
          "(N), of the body below the surface, m; nan without a pressure sensor")
      .def_property_readonly(
          "statuses", [](Type t) { return names(t, [](const Row& r) { return toString(r.status); }); },
          "(N) str: tracking, degraded or inertial")
      .def_property_readonly(
          "magnetometer_statuses",
          [](Type t) { return names(t, [](const Row& r) { return toString(r.magnetometer); }); },
          "(N) str: off, no_data, used or why it was rejected")
      .def_property_readonly(
          "are_keyframes",
          [](Type t) { return column<bool>(t.rows, [](const Row& r) { return r.is_keyframe; }); }, "(N) bool")
      .def_property_readonly(
          "track_counts",
          [](Type t) { return column<int32_t>(t.rows, [](const Row& r) { return r.tracks; }); },
          "(N) int32, points seen in each frame")
      .def_property_readonly(
          "landmark_counts",
          [](Type t) { return column<int32_t>(t.rows, [](const Row& r) { return r.landmarks; }); },
          "(N) int32, tracks that have a position")
      .def_property_readonly(
          "reprojection_rms",
          [](Type t) {
            return column<double>(t.rows, [](const Row& r) { return r.reprojection_rms_sigmas; });
          },
          "(N), in sigmas of an observation")
      .def_property_readonly(
          "landmarks",
          [](Type t) { return stack(t.landmarks, [](const MapPoint& p) { return p.position_W; }); },
          "(M, 3), m, world axes")
      .def_property_readonly(
          "landmark_observations",
          [](Type t) {
            return column<int32_t>(t.landmarks, [](const MapPoint& p) { return p.observations; });
          },
          "(M) int32")
      .def_property_readonly(
          "trajectory", [](Type t) { return t.trajectory("estimates"); },
          "the poses for evaluate() and files");
}

}  // namespace lodeline::python
