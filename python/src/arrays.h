#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

/// Conversions between Lodeline's types and those of Python. Arrays that go out are copies in C order.
namespace lodeline::python {

namespace py = pybind11;

/// An array of numbers that may have any type and layout; it is converted to doubles in C order.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Text of a message or a file, also where its bytes are no UTF-8.
py::str printable(const std::string& text);
/// A JSON text as dicts and lists.
py::object fromJson(const std::string& json);
/// A setting's value in YAML syntax: 3, true, [1, 2].
std::string yamlText(py::handle value);

py::list findingsOf(const Diagnostics& diagnostics);
/// Raises the Python warning `FindingWarning` for each finding that is at least a warning. It is for
/// functions whose result has no findings.
void warn(const Diagnostics& diagnostics);

/// Whether a callback's answer ends the work: False in any form, also NumPy's; not None.
inline bool endsWork(const py::object& answer) {
  if (answer.is_none()) return false;
  const int truth = PyObject_IsTrue(answer.ptr());
  if (truth < 0) throw py::error_already_set();
  return truth == 0;
}

/// The result of `work`, during which other threads of Python go on.
template <typename Work>
auto withoutGil(const Work& work) {
  const py::gil_scoped_release released;
  return work();
}

/// Times from an integer or an array of integers (N), nanoseconds. Throws py::type_error for any other type,
/// such as seconds in floating-point numbers.
std::vector<Time> timesFrom(py::handle times_ns);
/// Vectors from an array (N, 3), or (3) where N is 1. Throws py::value_error, naming `what`, for another
/// shape.
std::vector<Vec3> vectorsFrom(const Doubles& array, size_t count, const char* what);
/// Numbers from an array (N), or a number where N is 1.
std::vector<double> numbersFrom(const Doubles& array, size_t count, const char* what);
/// A pose from an array (4, 4).
Rigid3 rigidFrom(const Doubles& matrix, const char* what);
/// The same; without an array, the identity.
Rigid3 rigidOr(const std::optional<Doubles>& matrix, const char* what);

py::array_t<double> arrayOf(const Rigid3& transformation);
/// [w, x, y, z] with w >= 0.
Eigen::Vector4d quaternionOf(const Quat& rotation);

/// An array (N) of `value` of each item.
template <typename Number, typename Items, typename Value>
py::array_t<Number> column(const Items& items, const Value& value) {
  py::array_t<Number> array(static_cast<py::ssize_t>(items.size()));
  Number* place = array.mutable_data();
  for (const auto& item : items) *place++ = static_cast<Number>(value(item));
  return array;
}

template <typename Items, typename Value>
py::array_t<int64_t> timeColumn(const Items& items, const Value& time) {
  return column<int64_t>(items, [&](const auto& item) { return time(item).nanoseconds(); });
}

/// An array (N, rows) or (N, rows, columns) of the fixed-size matrix `value` of each item.
template <typename Items, typename Value>
py::array_t<double> stack(const Items& items, const Value& value) {
  using Matrix = std::decay_t<decltype(value(*items.begin()))>;
  constexpr auto kRows = Matrix::RowsAtCompileTime;
  constexpr auto kColumns = Matrix::ColsAtCompileTime;
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(items.size()), kRows};
  if (kColumns != 1) shape.push_back(kColumns);
  py::array_t<double> array(shape);
  double* place = array.mutable_data();
  for (const auto& item : items) {
    const Matrix matrix = value(item);
    for (Eigen::Index row = 0; row < kRows; ++row) {
      for (Eigen::Index column = 0; column < kColumns; ++column) *place++ = matrix(row, column);
    }
  }
  return array;
}

}  // namespace lodeline::python
