#include "lodeline/util/edit_distance.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace lodeline {

size_t editDistance(std::string_view a, std::string_view b) {
  // row[j] is the distance from the first i characters of a to the first j of b.
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace lodeline
