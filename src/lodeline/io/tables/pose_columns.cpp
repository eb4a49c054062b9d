#include "lodeline/io/tables/pose_columns.h"

#include <map>
#include <string>

#include "lodeline/io/tables/units.h"

namespace lodeline {
namespace {

constexpr std::string_view kAxes = "xyzw";

/// One component of a vector or quaternion.
struct Component {
  std::size_t axis = 0;  ///< 0 to 3: x y z w
  std::string group;     ///< equal for all components of one vector
  bool is_rotation = false;
  bool is_position = false;
  bool is_numbered = false;  ///< q0 to q3, axis 0 to 3 by the number
};

bool isOther(const ColumnName& column) {
  return column.hasStem(
             {"vel", "acc", "bias", "cov", "twist", "angular", "linear", "gyr", "mag", "std", "sigma"}) ||
         column.hasWord({"v", "b"}) ||
         (column.hasWord({"a", "g", "m"}) && !column.hasWord({"p", "q"}));  // "p_G_Ix": of a frame G
}

std::optional<Component> componentOf(const ColumnName& column) {
  if (isOther(column)) return std::nullopt;
  Component component;
  std::string joined;  // the letter before the axis in the same word: "q" of "qx"
  std::size_t at = column.words.size();
  for (std::size_t i = column.words.size(); i-- > 0 && at == column.words.size();) {
    const std::string& word = column.words[i];
    if (word.size() > 2 || kAxes.find(word.back()) == std::string_view::npos) continue;
    const bool is_joined = word[0] == 'q' || word[0] == 't' || word[0] == 'p';
    // A frame before the axis: "p_G_Ix".
    if (word.size() == 2 && !is_joined && (i == 0 || !column.hasWord({"p", "q"}))) continue;
    component.axis = kAxes.find(word.back());
    joined = word.substr(0, word.size() - 1);
    at = i;
  }
  const std::size_t count = column.words.size();
  if (at == count) {
    const bool is_numbered = count >= 2 && column.words[count - 2] == "q" &&
                             column.words.back().size() == 1 && column.words.back()[0] >= '0' &&
                             column.words.back()[0] <= '3';
    if (!is_numbered) return std::nullopt;
    component.is_numbered = true;
    component.axis = static_cast<std::size_t>(column.words.back()[0] - '0');
    at = count - 1;
  }
  component.group = joined;
  for (std::size_t i = 0; i < count; ++i) {
    if (i != at) component.group += "_" + column.words[i];
  }
  component.is_rotation =
      joined == "q" || column.hasWord({"q", "rotation", "rot"}) || column.hasStem({"quat", "orient"});
  const bool is_named = joined == "t" || joined == "p" || column.hasWord({"p", "t"}) ||
                        column.hasStem({"pos", "transl", "trans", "loc"});
  component.is_position = !component.is_rotation && component.axis < 3 && (is_named || count == 1);
  return component;
}

/// Columns of a vector found so far.
struct PoseGroup {
  std::array<std::optional<std::size_t>, 4> column;
  bool is_rotation = false;
  bool is_position = false;
  bool is_numbered = false;
  bool has(std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) {
      if (!column[i]) return false;
    }
    return true;
  }
};

}  // namespace

std::optional<PoseColumns> findPoseColumns(const std::vector<ColumnName>& columns) {
  std::vector<PoseGroup> groups;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::optional<Component> component = componentOf(columns[i]);
    if (!component) continue;
    const auto [at, is_new] = index.emplace(component->group, groups.size());
    if (is_new) groups.emplace_back();
    PoseGroup& group = groups[at->second];
    if (!group.column[component->axis]) group.column[component->axis] = i;
    group.is_rotation = group.is_rotation || component->is_rotation;
    group.is_position = group.is_position || component->is_position;
    group.is_numbered = group.is_numbered || component->is_numbered;
  }
  const PoseGroup* position = nullptr;
  const PoseGroup* rotation = nullptr;
  for (const PoseGroup& group : groups) {
    if (group.is_rotation && group.has(4) && rotation == nullptr) rotation = &group;
    if (!group.is_rotation && group.is_position && group.has(3) && position == nullptr) position = &group;
  }
  if (position == nullptr || rotation == nullptr) return std::nullopt;
  PoseColumns result;
  for (std::size_t i = 0; i < 3; ++i) result.position[i] = *position->column[i];
  // q0 is w: numbers 1, 2, 3, 0 are x y z w.
  const std::size_t shift = rotation->is_numbered ? 1 : 0;
  for (std::size_t i = 0; i < 4; ++i) result.rotation[i] = *rotation->column[(i + shift) % 4];
  result.w_is_assumed_first = rotation->is_numbered;
  const StatedUnit unit = statedUnit(columns[result.position[0]], Quantity::Length);
  result.position_to_m = unit.factor.value_or(1.0);
  // "[-]" states none.
  if (unit.text.find_first_not_of('-') != std::string::npos && !unit.factor) result.unknown_unit = unit.text;
  return result;
}

}  // namespace lodeline
