#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/tables/column_name.h"

namespace lodeline {

/// Which columns of a dive log hold what.
struct ProfileColumns {
  size_t depth = 0;
  std::optional<size_t> time;
  std::optional<size_t> date;  ///< of the day, where the time is that of a clock
  std::optional<size_t> dive;  ///< number of the dive
};

/// The columns by their names; nothing where none is the depth of each sample. Where several may be that, the
/// first of the plainest name is taken ("Sample Depth", then "Depth", then "Depth below surface").
std::optional<ProfileColumns> profileColumns(const std::vector<ColumnName>& names);

}  // namespace lodeline
