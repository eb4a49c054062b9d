#include <glog/logging.h>
#include <pybind11/pybind11.h>

#include "lodeline/version.h"
#include "python/src/bindings.h"

PYBIND11_MODULE(_lodeline, module) {
  // Warnings of Ceres are about steps from which it recovers, as in the program.
  FLAGS_minloglevel = google::GLOG_ERROR;
  module.doc() = "Lodeline: visual-inertial-magnetic odometry. Import `lodeline`, not this module.";
  module.attr("__version__") = LODELINE_VERSION;
  lodeline::python::bindErrors(module);
  lodeline::python::bindRig(module);
  lodeline::python::bindTrajectory(module);
  lodeline::python::bindEstimates(module);
  lodeline::python::bindRecording(module);
  lodeline::python::bindRun(module);
  lodeline::python::bindOdometry(module);
  lodeline::python::bindEvaluation(module);
  lodeline::python::bindCalibration(module);
  lodeline::python::bindSimulation(module);
}
