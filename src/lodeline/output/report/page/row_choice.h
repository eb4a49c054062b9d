#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lodeline {

/// Which rows of a long table a page shows.
struct RowChoice {
  size_t stride = 1;         ///< every so manieth row is there
  std::vector<size_t> rows;  ///< in order
};

/// Every n-th of `count` rows and the last one, at most about `most`; and besides, so that no short trouble
/// is lost, the rows at which a word changes in one of the columns `words`, unless these are more than
/// `most`.
RowChoice chooseRows(size_t count, size_t most, const std::vector<const std::vector<std::string>*>& words);

}  // namespace lodeline
