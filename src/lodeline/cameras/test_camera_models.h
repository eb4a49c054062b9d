#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "lodeline/cameras/camera_model.h"

namespace lodeline::test {

/// A camera of a model with its typical lens and the first `count` of the lens's parameters; zeros follow.
inline CameraCalibration typicalCamera(const CameraModel& model, size_t count) {
  CameraCalibration c;
  c.name = "cam0";
  c.width_px = 752;
  c.height_px = 480;
  c.fx_px = 600.0;
  c.fy_px = 598.0;
  c.cx_px = 367.215;
  c.cy_px = 248.375;
  c.model = model.name;
  c.distortion = model.typical.parameters;
  c.distortion.resize(count, 0.0);
  const double on_axis_px = makeCamera(c)->focalLengthsOnAxis_px().x();
  const double factor = model.typical.focal_length_share * c.width_px / on_axis_px;
  c.fx_px *= factor;
  c.fy_px *= factor;
  return c;
}

/// Cameras of all registered models with all numbers of parameters that the models permit.
inline std::vector<CameraCalibration> typicalCameras() {
  std::vector<CameraCalibration> cameras;
  for (const CameraModel& model : cameraModels()) {
    for (const size_t count : model.counts) cameras.push_back(typicalCamera(model, count));
  }
  return cameras;
}

/// Name of a parameterized test: the model and its number of parameters.
inline std::string testName(const testing::TestParamInfo<CameraCalibration>& info) {
  std::string name = info.param.model + "_" + std::to_string(info.param.distortion.size());
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace lodeline::test
