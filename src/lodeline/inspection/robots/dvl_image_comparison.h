#pragma once

#include <optional>
#include <vector>

#include "lodeline/inspection/survey/camera_survey.h"
#include "lodeline/inspection/survey/inertial_path.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Consistency of a DVL with the images of a camera. Between two images, the rays f_1 and f_2 of a point and
/// the travel t of the camera lie in one plane:
///
///     t . (f_1 x R f_2) = 0
///
/// with the rotation R by the gyroscope. The direction of t comes from the images, its sign from the flow. It
/// must be that of the camera's velocity by the DVL. One camera does not tell the length of t.
struct DvlImageComparison {
  int pairs = 0;                      ///< of images with enough flow, and a velocity of the DVL between them
  double angle_rad = 0.0;             ///< median between both directions, with the axes as recorded
  double best_angle_rad = 0.0;        ///< with the best permutation of body axes
  Mat3 best_axes = Mat3::Identity();  ///< true from given
  double time_offset_s = 0.0;         ///< stamps + this = clock of the IMU, at the smallest angle
  double angle_at_offset_rad = 0.0;
};

/// Nothing where too few pairs of images determine a direction.
std::optional<DvlImageComparison> compareDvlWithImages(const std::vector<RayPairs>& pairs,
                                                       const Rigid3& body_from_camera,
                                                       const std::vector<DvlSample>& pings,
                                                       const DvlCalibration& dvl, const InertialPath& path);

/// Direction in which a camera travelled between two images, in its axes at the first; empty where there is
/// too little flow beside the rotation, or the points do not determine it.
std::optional<Vec3> travelDirection(const RayPairs& pairs, const Quat& first_from_second);

}  // namespace lodeline
