#pragma once

#include <span>
#include <string>
#include <vector>

#include "lodeline/mapping/control/control_factor.h"
#include "lodeline/mapping/control/tags/tag_observer.h"

namespace lodeline {

/// The tags seen at one keyframe as factors, those whose position in the body is known. A tag of `control`
/// keeps its name and position; another one becomes a point "tag NUMBER" of unknown position in `control`.
std::vector<ControlFactor> factorsOfTags(KeyframeId keyframe, std::span<const TagObservation> observations,
                                         ControlSet* control);

}  // namespace lodeline
