#include "lodeline/mapping/control/files/control_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "lodeline/mapping/control/files/control_table.h"
#include "lodeline/mapping/control/files/survex_files.h"

namespace lodeline {

const ControlPoint* ControlSet::find(const std::string& name) const {
  const auto found = std::find_if(points.begin(), points.end(),
                                  [&](const ControlPoint& point) { return point.name == name; });
  return found != points.end() ? &*found : nullptr;
}

void ControlSet::add(const ControlPoint& point) {
  auto* known = const_cast<ControlPoint*>(find(point.name));
  if (known == nullptr) {
    points.push_back(point);
    return;
  }
  const auto contradict = [&](const char* what) {
    throw InputError(fmt::format("{}: the {} of '{}' differs from that at {}", point.origin, what, point.name,
                                 known->origin));
  };
  if (known->kind != point.kind) contradict("kind");
  if (known->tag && point.tag && *known->tag != *point.tag) contradict("tag");
  if (point.tag) known->tag = point.tag;
  if (!point.position) return;
  constexpr double kSame_m = 0.005;  // coordinates with two decimals
  if (known->position && (known->position->position - point.position->position).norm() > kSame_m)
    contradict("position");
  if (!known->position) {
    known->position = point.position;
    known->origin = point.origin;
  }
}

ControlReadOptions::Sigmas ControlReadOptions::sigmasOf(ControlKind kind) const {
  if (kind == ControlKind::Gps) return gps;
  return kind == ControlKind::Station ? station : mark;
}

void ControlReadOptions::check() const {
  for (const Sigmas& sigmas : {gps, station, mark}) {
    for (const double sigma_m : {sigmas.horizontal_m, sigmas.vertical_m}) {
      if (!(sigma_m > 0.0) || !std::isfinite(sigma_m))
        throw UsageError("the sigmas of control points must be positive");
    }
  }
  if (site && !(std::abs(site->latitude_deg) <= 90.0 && std::abs(site->longitude_deg) <= 180.0))
    throw UsageError("the site of the map has an impossible latitude or longitude");
}

ControlSet readControl(const std::filesystem::path& file, const ControlReadOptions& options,
                       Diagnostics* diagnostics) {
  options.check();
  if (isSurvex3d(file)) return controlOf(readSurvex3d(file), file, options);
  if (file.extension() == ".pos") return controlOf(readSurvexPositions(file), file, options);
  return readControlTable(file, options, diagnostics);
}

}  // namespace lodeline
