#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/cameras/ports/refractive_camera.h"
#include "lodeline/cameras/test_camera_models.h"

namespace lodeline::test {

struct PortCase {
  std::string name;
  CameraCalibration calibration;
};

inline Port flatPort(const Vec3& normal, double distance_m, double thickness_m) {
  Port port;
  port.normal_C = normal.normalized();
  port.distance_m = distance_m;
  port.thickness_m = thickness_m;
  return port;
}

inline Port domePort(const Vec3& centre_C, double radius_m, double thickness_m) {
  Port port;
  port.type = Port::Type::Dome;
  port.centre_C = centre_C;
  port.radius_m = radius_m;
  port.thickness_m = thickness_m;
  return port;
}

/// Two lenses, one of them a fisheye, behind plates and domes as built: aslant, thick, off the centre.
inline std::vector<PortCase> portCases() {
  Port sapphire = flatPort(Vec3(-0.05, 0.02, 1.0), 0.04, 0.003);
  sapphire.index_glass = 1.77;
  sapphire.index_water = 1.34;
  Port oil = flatPort(Vec3(0.02, -0.01, 1.0), 0.01, 0.006);
  oil.index_air = 1.4;
  const std::vector<std::pair<std::string, Port>> ports = {
      {"flat", flatPort(Vec3::UnitZ(), 0.015, 0.008)},
      {"flat_aslant", flatPort(Vec3(0.014, -0.03, 1.0), 0.015, 0.008)},
      {"flat_sapphire", sapphire},
      {"flat_oil", oil},
      {"dome_ahead", domePort(Vec3(0.001, -0.002, 0.006), 0.05, 0.007)},
      {"dome_behind", domePort(Vec3(-0.004, 0.002, -0.012), 0.05, 0.007)},
      {"dome_small", domePort(Vec3(0.0, 0.011, 0.0), 0.025, 0.003)},
      {"dome_near_centre", domePort(Vec3(1e-7, -2e-7, 1e-7), 0.05, 0.007)},
  };
  std::vector<PortCase> cases;
  for (const char* model : {"radial-tangential", "equidistant"}) {
    for (const auto& [name, port] : ports) {
      CameraCalibration c = typicalCamera(*findCameraModel(model), 4);
      c.port = port;
      cases.push_back({name + "_" + (c.model == "equidistant" ? "fisheye" : "lens"), c});
    }
  }
  return cases;
}

inline std::string portCaseName(const testing::TestParamInfo<PortCase>& info) { return info.param.name; }

inline std::shared_ptr<const RefractiveCamera> makeRefractive(const CameraCalibration& calibration) {
  return std::dynamic_pointer_cast<const RefractiveCamera>(makeCamera(calibration));
}

/// The parameters of a port in the order of DirectionByPort, changed by `change` in one of them.
inline Port movedPort(Port port, Eigen::Index parameter, double change) {
  const bool is_flat = port.type == Port::Type::Flat;
  if (is_flat && parameter < 2) {
    const Vec3 axis = Vec3::Unit(parameter);
    port.normal_C = Quat(Eigen::AngleAxisd(change, axis)) * port.normal_C;
    return port;
  }
  if (!is_flat && parameter < 3) {
    port.centre_C[parameter] += change;
    return port;
  }
  double* flat[] = {&port.distance_m, &port.thickness_m, &port.index_air, &port.index_glass,
                    &port.index_water};
  double* dome[] = {&port.radius_m, &port.thickness_m, &port.index_air, &port.index_glass, &port.index_water};
  *(is_flat ? flat[parameter - 2] : dome[parameter - 3]) += change;
  return port;
}

}  // namespace lodeline::test
