#include "lodeline/output/foxglove/state_messages.h"

#include <cmath>
#include <numbers>

#include "lodeline/output/foxglove/foxglove_messages.h"

namespace lodeline::foxglove {
namespace {

constexpr const char* kAzimuth = "azimuth_of_body_x_deg";

/// Degrees from the world's y axis towards its x axis; clockwise seen from above.
double azimuth_deg(const Quat& world_from_body) {
  const Vec3 x_W = world_from_body * Vec3::UnitX();
  const double azimuth = std::atan2(x_W.x(), x_W.y()) * 180.0 / std::numbers::pi;
  return azimuth < 0.0 ? azimuth + 360.0 : azimuth;
}

}  // namespace

std::string fieldName(const std::string& column) {
  std::string name;
  for (const char c : column) {
    if (c == '/') {
      name += "_per_";
    } else if (c == ' ') {
      name += '_';
    } else if (c != '[' && c != ']' && c != '^') {
      name += c;
    }
  }
  return name;
}

StateMessages::StateMessages(const RunTable& table) : table_(table) {
  std::vector<std::string> number_names, word_names;
  for (const auto& [column, values] : table.numbers) {
    if (column.starts_with("cov_")) continue;
    numbers_.push_back({fieldName(column), &values});
    number_names.push_back(numbers_.back().name);
  }
  for (const auto& [column, values] : table.words) {
    words_.push_back({fieldName(column), &values});
    word_names.push_back(words_.back().name);
  }
  for (const char* column : {"q_w", "q_x", "q_y", "q_z"}) {
    const auto found = table.numbers.find(column);
    if (found != table.numbers.end()) rotation_.push_back(&found->second);
  }
  if (rotation_.size() != 4) rotation_.clear();
  if (!rotation_.empty()) number_names.emplace_back(kAzimuth);
  schema_ = stateSchema(number_names, word_names);
}

Json StateMessages::message(size_t row) const {
  Json message = {{"timestamp", timeJson(Time::fromNanoseconds(table_.stamp_ns[row]))}};
  for (const auto& field : words_) message[field.name] = (*field.values)[row];
  for (const auto& field : numbers_) {
    const double value = (*field.values)[row];
    if (std::isfinite(value)) message[field.name] = value;
  }
  if (rotation_.empty()) return message;
  const Quat q((*rotation_[0])[row], (*rotation_[1])[row], (*rotation_[2])[row], (*rotation_[3])[row]);
  if (q.coeffs().allFinite()) message[kAzimuth] = azimuth_deg(q);
  return message;
}

}  // namespace lodeline::foxglove
