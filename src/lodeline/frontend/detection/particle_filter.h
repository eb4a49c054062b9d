#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace lodeline {

/// Whether the brightest point near a corner is a particle: a small, isolated bright dot on a background with
/// much weaker texture. Flakes in the water, lit by the divers' lamps, look like that. Where the water is
/// milky they give the strongest corners of all, but they move with the water and not with the rock.
///
/// `image`: CV_32FC1, a half-size level of an ImagePyramid. `corner` must be at least `kParticleReachPx`
/// pixels inside it. The background is a ring around the brightest point within the window of the structure
/// tensor; its own gradient, e.g. from lamps, is subtracted.
bool isParticle(const cv::Mat& image, const cv::Point& corner);

/// Distance of the farthest pixel that `isParticle` reads.
constexpr int kParticleReachPx = 8;

}  // namespace lodeline
