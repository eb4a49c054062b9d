#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/lodeline/batch/batch_folder.h"
#include "apps/lodeline/batch/batch_list.h"

namespace lodeline {

/// Errors of a run that was compared with ground truth.
struct BatchErrors {
  double path_m = 0.0;  ///< of the ground truth
  double position_rmse_m = 0.0;
  double position_rmse_percent = 0.0;  ///< of the path
  double rotation_rmse_deg = 0.0;
  double drift_percent = 0.0;  ///< of the path
  double completion_percent = 0.0;
  std::optional<double> map_position_rmse_m;  ///< with loops closed (trajectory_map.tum)
};

/// One item in the table of a batch.
struct BatchRow {
  const BatchItem* item = nullptr;
  std::string status;  ///< done, failed, open; outdated where it was made from something else
  std::optional<int> exit_code;
  std::optional<int> frames;
  std::optional<int> frames_with_pose;
  std::optional<BatchErrors> errors;
  std::optional<BatchErrors> errors_before;  ///< in the batch that it is compared with
  std::string reason;                        ///< of a failure
};

/// The rows of all items: failed ones first, then by falling relative position error, open ones last.
/// `against` is the output folder of another batch, or empty.
std::vector<BatchRow> batchRows(const BatchList& list, const BatchFolder& folder,
                                const std::filesystem::path& against);

/// Writes table.csv and table.md, and returns the text of the latter.
std::string writeBatchTables(const std::vector<BatchRow>& rows, const BatchFolder& folder);

/// Text of a cell of a Markdown table.
std::string markdownText(std::string text);

/// All rows with all columns.
std::string batchCsv(const std::vector<BatchRow>& rows);

/// Medians and quartiles by variant, the comparison by variant, and the worst rows.
std::string batchMarkdown(const std::vector<BatchRow>& rows);

}  // namespace lodeline
