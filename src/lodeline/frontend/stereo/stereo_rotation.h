#pragma once

#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Unit rays of a point that two cameras observed at the same time.
struct RayPair {
  Vec3 first, second;
  /// Points of the rays in the frames of their cameras, m; away from the lens centres only behind ports.
  Vec3 first_origin = Vec3::Zero(), second_origin = Vec3::Zero();

  /// Transformation between the frames of the cameras moved to the origins of the rays.
  Rigid3 betweenOrigins(const Rigid3& second_from_first) const {
    return {second_from_first.rotation,
            second_from_first.rotation * first_origin + second_from_first.translation - second_origin};
  }
};

/// Unit normal, in the second camera's frame, of the plane through both cameras and a ray of the first one.
/// Empty where this plane does not exist: cameras at the same position, or a ray along the baseline.
std::optional<Vec3> epipolarNormal(const Rigid3& second_from_first, const Vec3& first_ray);

/// Estimates the rotation of a pair's second camera relative to its file from epipolar planes. A few tenths
/// of a degree exceed the tolerance of a match. Without the correction of a rotation across the planes there
/// would be no matches. A rotation about their common axis changes only the depths and remains unknown here.
///
/// n is the normal of the plane through both cameras and the point by the file. For a rotation theta of the
/// second camera (second_from_first becomes exp(theta) second_from_first), a match b has the residual
///   e(theta) = focal_px n^T exp(-theta) b.
/// The estimate minimizes the sum of |e| over the newest matches, correct and wrong ones (iteratively
/// reweighted least squares).
class StereoRotation {
 public:
  /// `limit_px`: tolerance of a match to its plane. Rotations with an effect below half of it are not
  /// corrected.
  StereoRotation(const Rigid3& second_from_first, double focal_px, double limit_px)
      : second_from_first_(second_from_first), focal_px_(focal_px), limit_px_(limit_px) {}

  /// Adds the matches of one frame. `second_from_first`: replaces that of the file where the second image was
  /// taken at another time.
  void add(const std::vector<RayPair>& pairs, const Rigid3& second_from_first);
  void add(const std::vector<RayPair>& pairs) { add(pairs, second_from_first_); }

  /// Whether most matches are off their planes with the file's rotation, but not with the estimated one.
  bool isFound() const { return found_; }
  /// theta, rad; zero until a deviation is found.
  Vec3 turn() const { return found_ ? turn_ : Vec3::Zero(); }

 private:
  /// Linearized for small rotations: error_px = e(0), slope = -de/dtheta.
  struct Equation {
    double error_px;
    Vec3 slope;
    double after(const Vec3& turn) const { return std::abs(error_px - slope.dot(turn)); }
  };
  void remember(const RayPair& pair, const Rigid3& second_from_first);
  void fit();
  double medianAfter(const Vec3& turn) const;

  Rigid3 second_from_first_;
  double focal_px_, limit_px_;
  std::deque<Equation> newest_;
  Vec3 turn_ = Vec3::Zero();
  bool found_ = false;
};

}  // namespace lodeline
