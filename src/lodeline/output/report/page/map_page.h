#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// Loops, map trajectory and control points of a run in the format of the page (`RunMap` in web/src/data.ts);
/// null where the run has no ledger of loops. It reads loops.csv, keyframes_map.tum and control.csv; the
/// last two may be missing. The map trajectory is left out where loops with another dive put it into another
/// frame. Throws InputError with file and line where a file has another format. An
/// incomplete last line of a run that was killed is skipped with a warning.
nlohmann::ordered_json runMapJson(const std::filesystem::path& run, int64_t origin_ns,
                                  Diagnostics* diagnostics);

}  // namespace lodeline
