#include "lodeline/output/survey/formats/therion_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "lodeline/output/survey/formats/survey_text.h"

namespace lodeline::therion_text {

using namespace survey_text;

std::optional<Georeference> placeOf(const DiveMap& map) {
  if (!map.place || map.place->gridDescription().therion_name) return map.place;
  return Georeference(map.place->origin(), MapGrid("auto", map.place->origin()));
}

Offsets::Offsets(const DiveMap& map, const Vec3& first_ENU)
    : place_(placeOf(map)), first_ENU_(first_ENU), start_depth_m_(map.start_depth_m) {}

Vec3 Offsets::operator()(const Vec3& point_ENU) const {
  if (!place_) return point_ENU - first_ENU_;
  return turnedClockwise(place_->grid(point_ENU) - rounded(place_->grid(first_ENU_)),
                         place_->convergence_rad());
}

Vec3 Offsets::fixed() const {
  return rounded(place_ ? place_->grid(first_ENU_) : Vec3(first_ENU_ - start_depth_m_ * Vec3::UnitZ()));
}

std::string csLine(const std::optional<Georeference>& place, const char* indent) {
  return place ? fmt::format("{}cs {}\n", indent, place->gridDescription().therion_name.value()) : "";
}

std::string dateText(const DiveMap& map) {
  if (map.date.empty()) return "";
  if (map.date < "2025") return fmt::format("    date {}\n", dotted(map.date));
  return fmt::format("    # date {}  (Therion 6.1 warns of dates after 2024)\n", dotted(map.date));
}

std::string person(std::string name) {
  std::replace(name.begin(), name.end(), '/', ' ');
  std::istringstream stream(name);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  std::string text;
  for (size_t i = 0; i < words.size(); ++i) {
    const bool is_surname = words.size() > 2 && i + 1 == words.size();
    text += (i == 0 ? "" : is_surname ? "/" : " ") + words[i];
  }
  return text;
}

}  // namespace lodeline::therion_text
