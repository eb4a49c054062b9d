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
/// The bytes, little-endian (columns and lengths as in packed_bytes.h):
///
///   version of the layout (1 byte), number of features (2 bytes), descriptors (32 bytes each)
///   code of the first track (8 bytes), bytes of a track code (1 byte), column of track codes
///   column of kinds (1 byte): bit c for a ray of camera c, bit 7 for a point
///   for each camera with rays: function of the pixels, function of the origins (RayFunctions)
///   steps of directions (2 bytes), step of distances (4 bytes)
///   columns of the first rays: u, v (2 bytes), sigma (1 byte)
///   columns of the points: distance (2 bytes), place across the first ray, sigma of the distance (1 byte)
///   x, y, z of the points without such a place (12 bytes each)
///   columns of the further rays: place relative to the point, sigma (1 byte)
///   columns u, v (2 bytes) of the further rays without such a place
///
/// A track code is 0 for a corner without track, 2d + 1 for a difference d >= 0 to the track before, and -2d
/// for a negative one. The column has 1 in place of the first code. A function begins with 1 for a polynomial
/// (BearingPolynomial) and 0 for a list of float32. Throws InputError for more than 65,535 features, a
/// feature without rays, and cameras beyond 6 or not in rising order. Bearings must be unit vectors, sigmas
/// positive, numbers finite.
Bytes packFeatures(const std::vector<MapFeature>& features);

/// Throws InputError where the bytes are not what packFeatures() wrote.
std::vector<MapFeature> unpackFeatures(std::span<const unsigned char> bytes);

}  // namespace lodeline
