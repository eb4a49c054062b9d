#include "lodeline/output/report/data/row_choice.h"

#include <algorithm>

namespace lodeline {
namespace {

bool changesAt(size_t row, const std::vector<const std::vector<std::string>*>& words) {
  return std::any_of(words.begin(), words.end(), [row](const std::vector<std::string>* column) {
    return (*column)[row] != (*column)[row - 1];
  });
}

}  // namespace

RowChoice chooseRows(size_t count, size_t most, const std::vector<const std::vector<std::string>*>& words) {
  RowChoice choice;
  if (count == 0) return choice;
  choice.stride = (count + most - 1) / most;
  std::vector<size_t> changes;
  for (size_t row = 1; row < count && choice.stride > 1; ++row) {
    if (changesAt(row, words)) changes.push_back(row);
  }
  if (changes.size() <= most) choice.rows = std::move(changes);
  for (size_t row = 0; row < count; row += choice.stride) choice.rows.push_back(row);
  choice.rows.push_back(count - 1);
  std::sort(choice.rows.begin(), choice.rows.end());
  choice.rows.erase(std::unique(choice.rows.begin(), choice.rows.end()), choice.rows.end());
  return choice;
}

}  // namespace lodeline
