#pragma once

#include <random>
#include <string>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/store/map_records.h"

namespace lodeline::test {

/// Features as a stereo rig sees them: pinhole cameras of 752 x 480 px, focal length 458 px, 11 cm apart,
/// bearings with noise of one sigma, most features with a point. `port_mm`: how far from the lens the rays at
/// 45 degrees meet the axis; it grows with the squared tangent, as behind a flat port.
std::vector<MapFeature> stereoFeatures(int count, double port_mm, std::mt19937* random);

/// A keyframe on a straight passage with those features, `number` steps of 33 cm from the start.
MapKeyframe passageKeyframe(DiveId dive, int number, int feature_count, std::mt19937* random);

MapDive namedDive(const std::string& name);

/// A symmetric positive definite matrix of standard deviations around `sigma`.
Mat6 someCovariance(double sigma, std::mt19937* random);

}  // namespace lodeline::test
