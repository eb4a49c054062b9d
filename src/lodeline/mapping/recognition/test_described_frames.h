#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/frontend/front_end.h"
#include "lodeline/mapping/recognition/keyframe_describer.h"

namespace lodeline {

/// Keyframe of one set of images without an estimator: the front end's matches between the cameras give the
/// positions. `world_from_body`: with z up; its roll and pitch are accurate to `tilt_sigma_rad`.
MapKeyframe keyframeOfImages(const Rig& rig, const std::vector<cv::Mat>& images,
                             const Rigid3& world_from_body, double tilt_sigma_rad);

}  // namespace lodeline
