#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

const char* toString(LoopStatus status) {
  switch (status) {
    case LoopStatus::Candidate:
      return "candidate";
    case LoopStatus::Matched:
      return "matched";
    case LoopStatus::Verified:
      return "verified";
    case LoopStatus::Accepted:
      return "accepted";
    case LoopStatus::Refused:
      return "refused";
  }
  return "";
}

}  // namespace lodeline
