#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/tables/column_name.h"

namespace lodeline {

/// The columns of a pose.
struct PoseColumns {
  std::array<std::size_t, 3> position = {};  ///< x y z
  std::array<std::size_t, 4> rotation = {};  ///< quaternion x y z w
  double position_to_m = 1.0;                ///< by the unit that the names state
  std::string unknown_unit;                  ///< a stated unit of the position that is no length
  bool w_is_assumed_first = false;           ///< the names are q0 to q3, without a statement of the order
};

/// Finds position and quaternion by the names of the columns: `tx`, `x`, `p_RS_R_x [m]`, `position x`,
/// `field.pose.pose.position.x`; `qx`, `q_WS_w`, `quaternion x`, `field.pose.pose.orientation.w`, and q0 to
/// q3 with w first. Returns nothing where position or quaternion is missing.
std::optional<PoseColumns> findPoseColumns(const std::vector<ColumnName>& columns);

}  // namespace lodeline
