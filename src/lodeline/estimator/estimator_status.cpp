#include "lodeline/estimator/estimator.h"

namespace lodeline {

const char* toString(Status status) {
  switch (status) {
    case Status::Waiting:
      return "waiting";
    case Status::Tracking:
      return "tracking";
    case Status::Degraded:
      return "degraded";
    case Status::Inertial:
      return "inertial";
  }
  return "unknown";
}

}  // namespace lodeline
