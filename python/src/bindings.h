#pragma once

#include <pybind11/pybind11.h>

namespace lodeline::python {

// Each function adds one subject to the module. Classes come before the functions that take or return them.
void bindErrors(pybind11::module_& module);
void bindRig(pybind11::module_& module);
void bindRobotSensors(pybind11::module_& module);  // by bindRig()
void bindTrajectory(pybind11::module_& module);
void bindEstimates(pybind11::module_& module);
void bindRecording(pybind11::module_& module);
void bindRun(pybind11::module_& module);
void bindOdometry(pybind11::module_& module);
void bindEvaluation(pybind11::module_& module);
void bindCalibration(pybind11::module_& module);
void bindSimulation(pybind11::module_& module);

}  // namespace lodeline::python
