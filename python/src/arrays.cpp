#include "python/src/arrays.h"

#include <fmt/format.h>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/printable_text.h"

namespace lodeline::python {
namespace {

using Integers = py::array_t<int64_t, py::array::c_style | py::array::forcecast>;

std::string shapeOf(const py::array& array) {
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    text += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
  return "(" + text + ")";
}

}  // namespace

py::str printable(const std::string& text) { return py::str(printableText(text)); }

py::object fromJson(const std::string& json) { return py::module_::import("json").attr("loads")(json); }

std::string yamlText(py::handle value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::sequence>(value)) {
    std::string text;
    for (const py::handle item : value) text += (text.empty() ? "" : ", ") + yamlText(item);
    return "[" + text + "]";
  }
  return py::str(value).cast<std::string>();
}

py::list findingsOf(const Diagnostics& diagnostics) {
  py::list findings;
  for (const Finding& finding : diagnostics.ranked()) findings.append(finding);
  return findings;
}

void warn(const Diagnostics& diagnostics) {
  const py::object kind = py::module_::import("lodeline._lodeline").attr("FindingWarning");
  for (const Finding& finding : diagnostics.ranked()) {
    if (finding.severity == Severity::Notice) continue;
    const std::string text = printableText(fmt::format("{}: {}", finding.kind, finding.first_message));
    if (PyErr_WarnEx(kind.ptr(), text.c_str(), 1) != 0) throw py::error_already_set();
  }
}

std::vector<Time> timesFrom(py::handle times_ns) {
  const py::array given = py::array::ensure(times_ns);
  if (!given || (given.dtype().kind() != 'i' && given.dtype().kind() != 'u' && given.size() > 0))
    throw py::type_error("times_ns: integer nanoseconds are wanted, an int or an array of type int64");
  if (given.ndim() > 1) throw py::value_error("times_ns: wanted shape (N), found " + shapeOf(given));
  const Integers array = Integers::ensure(given);
  std::vector<Time> times;
  times.reserve(static_cast<size_t>(array.size()));
  for (py::ssize_t i = 0; i < array.size(); ++i) times.push_back(Time::fromNanoseconds(array.data()[i]));
  return times;
}

std::vector<Vec3> vectorsFrom(const Doubles& array, size_t count, const char* what) {
  const auto wanted = static_cast<py::ssize_t>(count);
  const bool is_one = array.ndim() == 1 && wanted == 1 && array.shape(0) == 3;
  if (!is_one && (array.ndim() != 2 || array.shape(0) != wanted || array.shape(1) != 3))
    throw py::value_error(fmt::format("{}: wanted shape ({}, 3), found {}", what, count, shapeOf(array)));
  std::vector<Vec3> vectors;
  vectors.reserve(count);
  for (size_t i = 0; i < count; ++i) vectors.emplace_back(array.data() + 3 * i);
  return vectors;
}

std::vector<double> numbersFrom(const Doubles& array, size_t count, const char* what) {
  if (array.ndim() > 1 || array.size() != static_cast<py::ssize_t>(count))
    throw py::value_error(fmt::format("{}: wanted shape ({}), found {}", what, count, shapeOf(array)));
  return {array.data(), array.data() + count};
}

Rigid3 rigidFrom(const Doubles& matrix, const char* what) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw py::value_error(fmt::format("{}: wanted shape (4, 4), found {}", what, shapeOf(matrix)));
  return Rigid3::fromMatrix(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data()),
                            what);
}

Rigid3 rigidOr(const std::optional<Doubles>& matrix, const char* what) {
  return matrix ? rigidFrom(*matrix, what) : Rigid3();
}

py::array_t<double> arrayOf(const Rigid3& transformation) {
  py::array_t<double> array({4, 4});
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(array.mutable_data()) = transformation.matrix();
  return array;
}

Eigen::Vector4d quaternionOf(const Quat& rotation) {
  const Quat q = so3::canonical(rotation);
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace lodeline::python
