#include "apps/lodeline/shared/place_argument.h"

#include <fmt/format.h>

namespace lodeline {

GeodeticPosition placeFromText(const std::string& text, const std::string& option, Diagnostics* diagnostics) {
  const StatedPlace place = parsePlace(text, option);
  if (!place.has_height) {
    diagnostics->report(Severity::Notice, "height_assumed",
                        fmt::format("{} {}: no height is stated, 0 m is assumed", option, text));
  }
  return place.position;
}

}  // namespace lodeline
