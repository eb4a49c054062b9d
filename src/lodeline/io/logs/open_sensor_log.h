#pragma once

#include <filesystem>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/io/logs/readings/sensor_log.h"

namespace lodeline {

/// Whether the content of a path is a sensor log: a table of readings, a folder or zip archive of such
/// tables, a ULog or a DataFlash log. False for bags, recordings in the EuRoC layout and missing paths.
/// Throws InputError, with its kind, for any other file.
bool isSensorLog(const std::filesystem::path& path);

/// Opens a sensor log by its content. For a log of several parts, it reports from which part each sensor
/// comes, and its unit, as the finding `log_content`; for a table, the columns and units that its header does
/// not state. `options` apply to tables. Throws InputError where the file is damaged, has no
/// readings, or has readings in an unknown unit. `diagnostics` must outlive the log.
std::unique_ptr<SensorLog> openSensorLog(const std::filesystem::path& path, const PlainCsvOptions& options,
                                         Diagnostics* diagnostics);

}  // namespace lodeline
