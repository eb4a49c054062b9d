#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

namespace lodeline {

/// Points, m, with colours (red, green, blue) or without.
struct ColouredPoints {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<uint8_t, 3>> colours;  ///< empty, or one a point
};

/// Points in the format of the page (`Cloud` in web/src/data.ts), at most `most` of them, evenly chosen.
/// Coordinates are 16-bit numbers of steps from the lowest corner: 8 mm in a cave of 500 m.
nlohmann::ordered_json cloudJson(const ColouredPoints& points, size_t most);

}  // namespace lodeline
