#pragma once

#include <string>
#include <vector>

#include "lodeline/output/files/run_table.h"
#include "lodeline/output/foxglove/foxglove_schemas.h"

/// Rows of states.csv as plain JSON objects, whose fields a plot finds by name.
namespace lodeline::foxglove {

/// The name of a column as a field: "v_x_m_per_s" for "v_x [m/s]".
std::string fieldName(const std::string& column);

/// Columns of the table that become fields: all but the entries of covariances.
class StateMessages {
 public:
  explicit StateMessages(const RunTable& table);

  const Json& schema() const { return schema_; }
  /// One row. Values that are not finite are left out, because JSON has no text for them.
  Json message(size_t row) const;

 private:
  template <typename Value>
  struct Field {
    std::string name;
    const std::vector<Value>* values = nullptr;
  };

  const RunTable& table_;
  std::vector<Field<double>> numbers_;
  std::vector<Field<std::string>> words_;
  std::vector<const std::vector<double>*> rotation_;  ///< w x y z; empty where the table has none
  Json schema_;
};

}  // namespace lodeline::foxglove
