#pragma once

#include <CLI/App.hpp>

#include "apps/lodeline/export/export_dives.h"

namespace lodeline {

/// Options of formats, place and survey, which all commands that write map files share.
void addMapFileOptions(CLI::App* command, ExportArguments* arguments);

/// `lodeline export`: a run as survey and map files.
void addExportCommand(CLI::App& program);

}  // namespace lodeline
