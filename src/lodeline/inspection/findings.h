#pragma once

#include "lodeline/inspection/inspection.h"

/// Each adds to Inspection::findings what its sensors show. They judge from the surveys alone.
namespace lodeline::findings {

void judgeStreams(Inspection* inspection);
void judgeImu(Inspection* inspection);
void judgeImages(Inspection* inspection);
void judgeExtrinsics(Inspection* inspection);
void judgeTurning(Inspection* inspection);
void judgeMagnetometer(Inspection* inspection);

}  // namespace lodeline::findings
