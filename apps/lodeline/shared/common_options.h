#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {

/// How much a command prints.
struct Verbosity {
  bool quiet = false;  ///< no progress, no summary, and of the findings only serious ones, on standard error
  bool verbose = false;  ///< more figures, and the kind of each finding
};
void addVerbosity(Verbosity* verbosity, CLI::App* command);

/// Prints the findings to `stream`, most severe first, coloured by their severity on a terminal.
void printFindings(const Diagnostics& diagnostics, const Verbosity& verbosity, std::FILE* stream = stdout);

/// Place and date of a recording, for true north.
struct SiteArguments {
  std::string position;  ///< see parsePlace(); empty for none
  std::string date;      ///< YYYY-MM-DD; empty for none

  /// The Earth's field there; nothing without both. Throws UsageError where only one is given.
  std::optional<Vec3> field_ENU() const;
  /// "LATITUDE,LONGITUDE,HEIGHT" in degrees and metres; empty for none.
  std::string numbers() const;
};
void addSite(SiteArguments* site, CLI::App* command);

/// Part of a recording, in seconds from its start.
struct RecordingPart {
  double from_s = 0.0;
  std::optional<double> to_s;

  bool isAll() const { return from_s == 0.0 && !to_s; }
  /// Length of the part; nothing where it ends with the recording. Throws UsageError where it is empty.
  std::optional<double> length_s() const;
};
void addRecordingPart(RecordingPart* part, CLI::App* command);

/// `cameras`: numbers of the cameras to use; empty for all.
void addCameras(std::vector<int>* cameras, CLI::App* command);

/// `overwrite`: whether earlier results in the output may be replaced.
void addOverwrite(bool* overwrite, CLI::App* command);

}  // namespace lodeline
