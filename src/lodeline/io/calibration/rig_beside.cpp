#include "lodeline/io/calibration/rig_beside.h"

#include <fmt/core.h>

namespace lodeline {

std::filesystem::path rigFileBeside(const std::filesystem::path& recording) {
  std::filesystem::path file = recording.has_filename() ? recording : recording.parent_path();
  if (file.extension() == ".zstd") file.replace_extension();
  // The name of a folder, which may not exist yet, can have dots.
  const std::string extension = file.extension().string();
  const bool is_bag = extension == ".bag" || extension == ".db3" || extension == ".mcap";
  std::error_code ignored;
  if (is_bag || std::filesystem::is_regular_file(recording, ignored)) file.replace_extension();
  file += ".rig.yaml";
  return file;
}

RigFile readRigOf(const std::filesystem::path& recording, const std::string& kind,
                  const std::vector<std::filesystem::path>& rig_files, bool needs_calibration,
                  Diagnostics* diagnostics) {
  if (!rig_files.empty()) return readRigFiles(rig_files, diagnostics);
  const std::filesystem::path beside = rigFileBeside(recording);
  if (std::filesystem::exists(beside)) return readRigFiles({beside}, diagnostics);
  if (!needs_calibration) return {};
  throw InputError(
      fmt::format("{}: {} does not hold the calibration; describe the rig with --rig FILE, or in {} "
                  "(docs/reference/file-formats.md shows how)",
                  recording.string(), kind, beside.string()));
}

}  // namespace lodeline
