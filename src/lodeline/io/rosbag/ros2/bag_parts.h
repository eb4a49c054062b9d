#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// The files of a ROS 2 bag.
struct BagParts {
  std::vector<std::filesystem::path> files;         ///< in the order of recording
  std::optional<uint64_t> promised_messages = {};   ///< as metadata.yaml states; nothing without it
  std::map<std::string, std::string> formats = {};  ///< serialization of each topic, as metadata.yaml states
};

/// Finds the files of a bag. `bag`: one file (.db3, .mcap, also with .zstd), or a folder. In a folder,
/// metadata.yaml names the files; where it is missing or damaged (`bag_metadata`), all of them are taken in
/// the order of the numbers in their names. Reports missing files as `bag_part_missing`, and files that
/// metadata.yaml does not name as `bag_part_unused`. Throws InputError for a folder without a file of a bag.
BagParts findBagParts(const std::filesystem::path& bag, Diagnostics* diagnostics);

}  // namespace lodeline
