#pragma once

#include <memory>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/rig.h"

namespace lodeline {

/// The fusions of all kinds of sensors, in the order in which their terms are added. `options` and
/// `diagnostics` must outlive them.
std::vector<std::unique_ptr<SensorFusion>> makeSensorFusions(const Rig& rig, const EstimatorOptions& options,
                                                             Diagnostics* diagnostics);

}  // namespace lodeline
