#pragma once

#include <vector>

#include "lodeline/inspection/inspection.h"

namespace lodeline {

/// Reads the streams of pressure sensor, sonar, altimeter, DVL and currents, as far as the rig has them.
std::vector<PlainSurvey> surveyOtherSensors(MeasurementSource* source);

}  // namespace lodeline
