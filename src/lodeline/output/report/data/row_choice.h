#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lodeline {

/// Rows of a long table that a page shows.
struct RowChoice {
  size_t stride = 1;         ///< every `stride`-th row is included
  std::vector<size_t> rows;  ///< in order
};

/// Chooses every n-th of `count` rows and the last one, at most about `most`. It also includes rows in which
/// a word changes in one of the columns `words`, unless these exceed `most`. So short problems stay visible.
RowChoice chooseRows(size_t count, size_t most, const std::vector<const std::vector<std::string>*>& words);

}  // namespace lodeline
