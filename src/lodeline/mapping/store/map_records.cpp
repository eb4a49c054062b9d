#include "lodeline/mapping/store/map_records.h"

namespace lodeline {

bool MapDescription::operator==(const MapDescription& other) const {
  const auto same = [](const std::optional<GeodeticPosition>& a, const std::optional<GeodeticPosition>& b) {
    if (!a || !b) return !a && !b;
    return a->latitude_deg == b->latitude_deg && a->longitude_deg == b->longitude_deg &&
           a->height_m == b->height_m;
  };
  return frame == other.frame && field_reference == other.field_reference && same(site, other.site);
}

const char* toString(ControlKind kind) {
  switch (kind) {
    case ControlKind::Gps:
      return "gps";
    case ControlKind::Station:
      return "station";
    case ControlKind::Tag:
      return "tag";
    case ControlKind::Tie:
      return "tie";
  }
  return "";
}

std::optional<ControlKind> controlKindFrom(const std::string& word) {
  for (const ControlKind kind :
       {ControlKind::Gps, ControlKind::Station, ControlKind::Tag, ControlKind::Tie}) {
    if (word == toString(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace lodeline
