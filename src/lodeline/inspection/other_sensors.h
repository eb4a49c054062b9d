#pragma once

#include <vector>

#include "lodeline/inspection/inspection.h"

namespace lodeline {

/// Reads the streams of pressure sensor, sonar, altimeter, DVL and currents, as far as the rig has them.
std::vector<PlainSurvey> surveyOtherSensors(MeasurementSource* source);

/// Compares the DVL with the IMU, and the currents with the magnetometer, after the surveys of IMU and
/// magnetometer. Opens the recording again.
void compareRobotSensors(const SourceFactory& open, Inspection* inspection);

}  // namespace lodeline
