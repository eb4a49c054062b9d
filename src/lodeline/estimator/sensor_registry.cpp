#include "lodeline/estimator/sensor_registry.h"

#include "lodeline/estimator/dvl/dvl_fusion.h"
#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"
#include "lodeline/estimator/pressure/depth_fusion.h"
#include "lodeline/estimator/sonar/sonar_fusion.h"

namespace lodeline {

std::vector<std::unique_ptr<SensorFusion>> makeSensorFusions(const Rig& rig, const EstimatorOptions& options,
                                                             Diagnostics* diagnostics) {
  std::vector<std::unique_ptr<SensorFusion>> sensors;
  sensors.push_back(std::make_unique<MagnetometerFusion>(rig, options, diagnostics));
  sensors.push_back(std::make_unique<DepthFusion>(rig, options, diagnostics));
  sensors.push_back(std::make_unique<SonarFusion>(rig, options, diagnostics));
  sensors.push_back(std::make_unique<AltimeterFusion>(rig, options, diagnostics));
  sensors.push_back(std::make_unique<DvlFusion>(rig, options, diagnostics));
  sensors.push_back(std::make_unique<DvlRangeFusion>(rig, options, diagnostics));
  return sensors;
}

}  // namespace lodeline
