#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/tables/column_name.h"

namespace lodeline {

/// Columns of a dive log.
struct ProfileColumns {
  size_t depth = 0;
  std::optional<size_t> time;
  std::optional<size_t> date;  ///< of the day, where the time is that of a clock
  std::optional<size_t> dive;  ///< number of the dive
};

/// The columns by their names; empty where none is the depth of each sample.
/// Among several candidates, the first with the clearest name is used ("Sample
/// Depth", then "Depth", then "Depth below surface").
std::optional<ProfileColumns> profileColumns(const std::vector<ColumnName>& names);

}  // namespace lodeline
