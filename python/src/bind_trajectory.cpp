#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "lodeline/trajectory.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

WorldUp upFrom(const std::string& up) {
  if (up == "z") return WorldUp::Z;
  if (up == "-y") return WorldUp::MinusY;
  throw UsageError(fmt::format("up '{}': must be 'z' or '-y'", up));
}

Trajectory trajectoryFrom(py::handle times_ns, const Doubles& poses, const std::string& name,
                          const std::string& up) {
  const std::vector<Time> times = timesFrom(times_ns);
  const auto count = static_cast<py::ssize_t>(times.size());
  if (poses.ndim() != 3 || poses.shape(0) != count || poses.shape(1) != 4 || poses.shape(2) != 4)
    throw py::value_error(fmt::format("poses: wanted shape ({}, 4, 4)", times.size()));
  Trajectory trajectory;
  trajectory.name = name;
  trajectory.up = upFrom(up);
  trajectory.rows = times.size();
  const std::string what = name + ": pose";
  for (size_t i = 0; i < times.size(); ++i) {
    using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
    const Eigen::Map<const Matrix> matrix(poses.data() + 16 * i);
    trajectory.poses.push_back({times[i], Rigid3::fromMatrix(matrix, what.c_str())});
  }
  Diagnostics diagnostics;
  sortByTime(trajectory, diagnostics);
  warn(diagnostics);
  return trajectory;
}

}  // namespace

void bindTrajectory(py::module_& module) {
  using Type = const Trajectory&;
  py::class_<Trajectory>(module, "Trajectory", "N poses of a body in the order of their times.")
      .def(py::init(&trajectoryFrom), py::arg("times_ns"), py::arg("poses"), py::arg("name") = "trajectory",
           py::arg("up") = "z",
           "times_ns: (N) integers, ns. poses: (N, 4, 4), world_from_body, m; rotations are orthonormal to\n"
           "0.001. up: axis of the world that points up, 'z' or '-y'. Poses are sorted by time.")
      .def("__len__", &Trajectory::size)
      .def_readonly("name", &Trajectory::name, "source, for messages")
      .def_property_readonly(
          "has_times", [](Type t) { return t.time_base == TimeBase::Stamps; },
          "whether times_ns are times; otherwise they number the rows of the file")
      .def_property_readonly(
          "up", [](Type t) { return t.up == WorldUp::Z ? "z" : "-y"; }, "axis that points up: 'z' or '-y'")
      .def_property_readonly(
          "times_ns", [](Type t) { return timeColumn(t.poses, [](const StampedPose& p) { return p.time; }); },
          "(N) int64, ns")
      .def_property_readonly(
          "poses",
          [](Type t) {
            return stack(t.poses, [](const StampedPose& p) { return p.world_from_body.matrix(); });
          },
          "(N, 4, 4), world_from_body, m")
      .def_property_readonly(
          "positions",
          [](Type t) {
            return stack(t.poses, [](const StampedPose& p) { return p.world_from_body.translation; });
          },
          "(N, 3), m")
      .def_property_readonly(
          "quaternions",
          [](Type t) {
            return stack(t.poses,
                         [](const StampedPose& p) { return quaternionOf(p.world_from_body.rotation); });
          },
          "(N, 4), [w, x, y, z], world_from_body")
      .def_property_readonly("path_length_m", &pathLength, "m")
      .def(
          "write_tum", [](Type t, const std::filesystem::path& file) { writeTum(t, file); }, py::arg("file"),
          "Writes `t[s] x y z qx qy qz qw`, times exact to 1 ns.");
  module.def(
      "read_trajectory",
      [](const std::filesystem::path& path, const std::optional<std::string>& format,
         const std::optional<std::filesystem::path>& image_times,
         const std::optional<Doubles>& body_from_camera) {
        TrajectoryReadOptions options;
        if (format) options.format = trajectoryFormatFromString(*format);
        options.image_times = image_times;
        if (body_from_camera) options.body_from_camera = rigidFrom(*body_from_camera, "body_from_camera");
        Diagnostics diagnostics;
        Trajectory trajectory = withoutGil([&] { return readTrajectory(path, options, diagnostics); });
        warn(diagnostics);
        return trajectory;
      },
      py::arg("path"), py::kw_only(), py::arg("format") = py::none(), py::arg("image_times") = py::none(),
      py::arg("body_from_camera") = py::none(),
      "Reads a trajectory: a table, TUM, KITTI, EuRoC ground truth, COLMAP, or the folder of a run.\n\n"
      "format: table, tum, kitti, euroc, colmap-text or colmap-binary; by default told from the file.\n"
      "image_times: file with the times of COLMAP images. body_from_camera: (4, 4), for COLMAP.");
}

}  // namespace lodeline::python
