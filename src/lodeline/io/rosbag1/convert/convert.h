#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct ConvertOptions {
  /// Files that describe the rig, and for bags topics by sensor, as in BagOptions.
  std::vector<std::filesystem::path> rig_files;
  std::map<std::string, std::string> topics;
  /// Of the bag that is written: "none", "lz4" or "bz2".
  std::string compression = "none";
};

struct ConvertSummary {
  std::map<std::string, int> readings;  ///< by sensor
  std::filesystem::path rig_file;       ///< written beside a bag; empty otherwise
};

/// Writes a recording in the EuRoC ASL layout into a bag, and its calibration as NAME.rig.yaml beside it. All
/// readings are kept to the bit with their stamps and their order, except for what the messages cannot hold,
/// which is reported as `convert_rounded`: sonar readings have 32 bits, depths become pressures and come back
/// to 1 nm. PNG images become Image messages with the same pixels, other files CompressedImage messages with
/// the same bytes. Of the true states, positions and attitudes are kept. Throws InputError where the bag is
/// there already or the recording cannot be read.
ConvertSummary convertFolderToBag(const std::filesystem::path& folder, const std::filesystem::path& bag,
                                  const ConvertOptions& options, Diagnostics* diagnostics);

/// The other way. Without a rig file the readings are written without calibration, which is reported. Colour
/// filter mosaics and YUV, which image files cannot hold, become grey. Throws InputError where the folder is
/// there already and not empty, or the bag cannot be read.
ConvertSummary convertBagToFolder(const std::filesystem::path& bag, const std::filesystem::path& folder,
                                  const ConvertOptions& options, Diagnostics* diagnostics);

/// The topic in which the true poses stand in bags that are written here.
inline constexpr const char* kTruthTopic = "/ground_truth/pose";

}  // namespace lodeline
