#include "lodeline/magnetometer/currents/current_verdict.h"

#include <fmt/format.h>

#include "lodeline/util/angles.h"

namespace lodeline {

std::string verdictOf(const CurrentFit& fit) {
  const double degrees = fit.correlated_rms_rad / kDegree;
  const double before = fit.without.heading_rms_rad / kDegree;
  const char* worth = degrees < 0.5 && fit.isComplete() ? "Good" : degrees < 2.0 ? "Usable" : "Weak";
  std::string text = fmt::format(
      "{}: currents turn the heading by {:.2f} degrees (root mean square) without compensation, {:.2f} with "
      "it.",
      worth, before, degrees);
  for (const CurrentChannel& channel : fit.channels) {
    if (!channel.isIdentified()) text += fmt::format(" Channel {}: {}.", channel.name, channel.objection);
  }
  if (degrees >= 2.0)
    text += " Something else changes the field: iron that moves, or a current without a sensor.";
  return text;
}

}  // namespace lodeline
