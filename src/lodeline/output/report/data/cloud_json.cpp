#include "lodeline/output/report/data/cloud_json.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

#include "lodeline/output/report/data/base64.h"
#include "lodeline/output/report/data/row_choice.h"

namespace lodeline {
namespace {

static_assert(std::endian::native == std::endian::little, "the page reads coordinates as they lie in memory");

constexpr float kMostSteps = std::numeric_limits<uint16_t>::max();

template <typename Value>
std::string encoded(const std::vector<Value>& values) {
  return base64({reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(Value)});
}

}  // namespace

nlohmann::ordered_json cloudJson(const ColouredPoints& points, size_t most) {
  const std::vector<size_t> rows = chooseRows(points.positions.size(), most, {}).rows;
  Eigen::Array3f low = Eigen::Array3f::Zero(), high = Eigen::Array3f::Zero();
  for (size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Array3f p = points.positions[rows[i]].array();
    low = i == 0 ? p : low.min(p).eval();
    high = i == 0 ? p : high.max(p).eval();
  }
  const Eigen::Array3f step = ((high - low) / kMostSteps).max(1e-6f);
  std::vector<uint16_t> steps;
  std::vector<uint8_t> colours;
  for (const size_t row : rows) {
    const Eigen::Array3f p = ((points.positions[row].array() - low) / step).round().min(kMostSteps);
    for (int k = 0; k < 3; ++k) steps.push_back(static_cast<uint16_t>(p[k]));
    if (!points.colours.empty())
      colours.insert(colours.end(), points.colours[row].begin(), points.colours[row].end());
  }
  return {{"total", points.positions.size()},
          {"low_m", {low[0], low[1], low[2]}},
          {"step_m", {step[0], step[1], step[2]}},
          {"xyz", encoded(steps)},
          {"rgb", encoded(colours)}};
}

}  // namespace lodeline
