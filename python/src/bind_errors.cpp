#include <filesystem>

#include "lodeline/diagnostics.h"
#include "lodeline/util/printable_text.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

/// Classes of the module; they live as long as the process.
struct ErrorClasses {
  PyObject* input = nullptr;
  PyObject* usage = nullptr;
  PyObject* estimation = nullptr;
};
ErrorClasses classes;

void raise(PyObject* error_class, const std::string& message) {
  PyErr_SetString(error_class, printableText(message).c_str());
}

/// Raises the errors of the library with the text that the program prints.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise(classes.input, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    raise(classes.input, error.path1().string() + ": " + error.code().message());
  } catch (const UsageError& error) {
    raise(classes.usage, error.what());
  } catch (const EstimationError& error) {
    raise(classes.estimation, error.what());
  }
}

PyObject* addClass(py::module_& module, const char* name, const char* documentation, PyObject* base) {
  PyObject* created =
      PyErr_NewExceptionWithDoc(("lodeline." + std::string(name)).c_str(), documentation, base, nullptr);
  module.attr(name) = py::reinterpret_borrow<py::object>(created);
  return created;
}

}  // namespace

void bindErrors(py::module_& module) {
  PyObject* base = addClass(module, "Error", "Base of the errors of Lodeline.", PyExc_RuntimeError);
  classes.input = addClass(module, "InputError",
                           "Input that cannot be used: a file is missing, damaged or contradicts another. "
                           "The program ends with exit code 1.",
                           base);
  classes.usage =
      addClass(module, "UsageError", "A wrong argument or setting. The program ends with exit code 2.", base);
  classes.estimation = addClass(module, "EstimationError",
                                "Readable input from which no trajectory could be estimated, or one that is "
                                "not to be trusted. The program ends with exit code 3.",
                                base);
  addClass(module, "FindingWarning", "A finding of a function whose result has no list of them.",
           PyExc_UserWarning);
  py::register_exception_translator(&translate);

  py::class_<Finding>(module, "Finding", "One kind of finding, however often it occurred.")
      .def_property_readonly(
          "severity", [](const Finding& f) { return toString(f.severity); }, "notice, warning or serious")
      .def_readonly("kind", &Finding::kind, "stable identifier, such as imu_gap")
      .def_property_readonly(
          "message", [](const Finding& f) { return printable(f.first_message); },
          "message of the first occurrence")
      .def_readonly("count", &Finding::count, "number of occurrences")
      .def("__repr__", [](const Finding& f) {
        return printable(std::string("<Finding ") + toString(f.severity) + " " + f.kind + " x" +
                         std::to_string(f.count) + ": " + f.first_message + ">");
      });
}

}  // namespace lodeline::python
