#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace lodeline {

/// Whether the brightest point near a corner is a particle: a small bright dot that stands alone on ground
/// whose texture is nothing beside it. Flakes adrift in the water, lit by the divers' lamps, look like that
/// and make the strongest corners of all where the water is milky, yet they move with the water and not with
/// the rock.
///
/// `image`: CV_32FC1, a half-size level of an ImagePyramid. `corner` must lie at least `kParticleReachPx`
/// pixels inside it. The ground is a ring about the brightest point within the window of the structure
/// tensor; a gradient of its own, as lamps cast one, is taken out of it.
bool isParticle(const cv::Mat& image, const cv::Point& corner);

/// Farthest pixel that `isParticle` looks at.
constexpr int kParticleReachPx = 8;

}  // namespace lodeline
