#pragma once

#include <span>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/store/pack/packed_bytes.h"

namespace lodeline {

/// The features of a keyframe in one block of about 40 bytes each. Descriptors and numbers of tracks are
/// exact. The rest is rounded to steps that are small against its uncertainty (quantization.h, RayFunctions).
/// Largest errors:
///
///   bearing of the first ray      7e-5 rad, or a quarter of the least sigma
///   bearings of further rays      a third of their sigma where the feature has a point, else as the first
///   point                         0.05 % of the distance, or an eighth of its sigma along the first ray;
///                                 across it a third of the ray's sigma
///   origins                       0.2 mm
///   pixels                        4 px; the bearing is what was measured
///   sigmas                        5 %
///
/// docs/reference/map-file.md describes the bytes. Throws InputError for more than 65,535 features, a feature
/// without rays, and cameras beyond 6 or not in rising order. Bearings must be unit vectors, sigmas positive,
/// numbers finite.
Bytes packFeatures(const std::vector<MapFeature>& features);

/// Throws InputError where the bytes are not what packFeatures() wrote.
std::vector<MapFeature> unpackFeatures(std::span<const unsigned char> bytes);

}  // namespace lodeline
