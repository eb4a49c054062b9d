#pragma once

#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/store/pack/packed_bytes.h"

namespace lodeline {

constexpr int kMostCamerasOfMap = 7;

/// Throws InputError where the features cannot be packed (feature_block.h).
void checkFeatures(const std::vector<MapFeature>& features);

/// Everything of features but their descriptors, column by column.
void writeColumns(const std::vector<MapFeature>& features, ByteWriter* writer);

/// Reads what writeColumns() wrote into as many features.
void readColumns(ByteReader* reader, std::vector<MapFeature>* features);

}  // namespace lodeline
