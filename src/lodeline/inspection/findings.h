#pragma once

#include "lodeline/inspection/inspection.h"

/// Each function adds the findings on its sensors to Inspection::findings. They use the surveys alone.
namespace lodeline::findings {

void judgeStreams(Inspection* inspection);
void judgeImu(Inspection* inspection);
void judgeImages(Inspection* inspection);
void judgeExtrinsics(Inspection* inspection);
void judgeTurning(Inspection* inspection);
void judgeMagnetometer(Inspection* inspection);
void judgeRobotSensors(Inspection* inspection);

}  // namespace lodeline::findings
