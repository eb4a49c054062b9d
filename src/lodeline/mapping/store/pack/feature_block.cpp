#include "lodeline/mapping/store/pack/feature_block.h"

#include "lodeline/mapping/store/pack/feature_columns.h"

namespace lodeline {
namespace {

constexpr uint8_t kVersion = 1;
}  // namespace

Bytes packFeatures(const std::vector<MapFeature>& features) {
  checkFeatures(features);
  ByteWriter writer;
  writer.integer<uint8_t>(kVersion);
  writer.integer(static_cast<uint16_t>(features.size()));
  for (const MapFeature& feature : features) {
    for (const uint64_t word : feature.descriptor.bits) writer.integer(word);
  }
  writeColumns(features, &writer);
  return writer.bytes();
}

std::vector<MapFeature> unpackFeatures(std::span<const unsigned char> bytes) {
  ByteReader reader(bytes);
  if (reader.integer<uint8_t>() != kVersion) throw InputError("the features have an unknown layout");
  std::vector<MapFeature> features(reader.integer<uint16_t>());
  for (MapFeature& feature : features) {
    for (uint64_t& word : feature.descriptor.bits) word = reader.integer<uint64_t>();
  }
  readColumns(&reader, &features);
  if (reader.left() > 0) throw InputError("the features are followed by further data");
  return features;
}

}  // namespace lodeline
