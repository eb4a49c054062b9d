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

/// Chooses every n-th of `count` rows and the last one, at most about `most`. It also includes the rows in
/// which a word changes in one of the columns `words`, so that short problems stay visible, unless these are
/// more than `most`.
RowChoice chooseRows(size_t count, size_t most, const std::vector<const std::vector<std::string>*>& words);

}  // namespace lodeline
