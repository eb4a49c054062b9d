#include <fmt/format.h>

#include <algorithm>

#include "lodeline/mapping/control/tags/tag_control.h"

namespace lodeline {
namespace {

const ControlPoint& pointOfTag(int tag, ControlSet* control) {
  const auto known = std::find_if(control->points.begin(), control->points.end(),
                                  [&](const ControlPoint& point) { return point.tag == tag; });
  if (known != control->points.end()) return *known;
  ControlPoint point;
  point.name = fmt::format("tag {}", tag);
  point.kind = ControlKind::Tag;
  point.tag = tag;
  point.origin = "images";
  control->add(point);
  return control->points.back();
}

}  // namespace

std::vector<ControlFactor> factorsOfTags(KeyframeId keyframe, std::span<const TagObservation> observations,
                                         ControlSet* control) {
  std::vector<ControlFactor> factors;
  for (const TagObservation& observation : observations) {
    if (!observation.centre_B) continue;
    const ControlPoint& point = pointOfTag(observation.tag, control);
    factors.push_back({point.name, ControlKind::Tag, keyframe, *observation.centre_B, point.position});
  }
  return factors;
}

}  // namespace lodeline
