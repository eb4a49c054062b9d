#include "lodeline/pipeline/output_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Path without links, dots and a trailing separator.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  const fs::path known = fs::weakly_canonical(path, error);
  const fs::path clean = (error ? fs::absolute(path) : known).lexically_normal();
  return clean.has_filename() ? clean : clean.parent_path();
}

bool isWithin(const fs::path& folder, const fs::path& path) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// The folder that contains only the recording.
fs::path folderOfSensors(const fs::path& data) {
  return fs::is_directory(data / "mav0") ? resolved(data / "mav0") : resolved(data);
}

}  // namespace

void refuseRecordingAsOutput(const fs::path& data, const fs::path& output) {
  const fs::path folder = resolved(output);
  const bool is_inside = isWithin(folderOfSensors(data), folder);
  if (!is_inside && folder != resolved(data) && !fs::exists(folder / "mav0")) return;
  throw UsageError(fmt::format(
      "-o {}: this folder holds a recording; results would mix with it. Choose another folder with -o",
      output.string()));
}

void refuseToReplaceRun(const fs::path& output) {
  for (const char* name : {"trajectory.tum", "trajectory_refined.tum", "states.csv", "run.json"}) {
    if (!fs::exists(output / name)) continue;
    throw UsageError(
        fmt::format("-o {}: the folder holds the results of another run ({}); choose another folder, or give "
                    "--overwrite to replace them",
                    output.string(), name));
  }
}

}  // namespace lodeline
