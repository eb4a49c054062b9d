#pragma once

#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "lodeline/geometry/rigid3.h"

namespace lodeline {

/// A point as two cameras saw it at the same time, unit rays.
struct RayPair {
  Vec3 first, second;
};

/// Unit normal, in the second camera's frame, of the plane through both cameras and a ray of the first one;
/// nothing where there is no such plane: cameras at one place, a ray along the baseline.
std::optional<Vec3> epipolarNormal(const Rigid3& second_from_first, const Vec3& first_ray);

/// How the second camera of a pair is turned against what its file says, as epipolar planes show it. A few
/// tenths of a degree are more than a match may be off, and where the turn is across the planes, no match
/// would be left without it; about their common axis it shows as depth only and remains unknown here.
///
/// With n the normal of the plane through both cameras and the point by the file, a turn theta of the second
/// camera (in its axes, second_from_first becomes exp(theta) second_from_first) leaves of a match b
///   e(theta) = focal_px n^T exp(-theta) b,
/// whose absolute values are minimized over the newest matches, right and wrong ones (iteratively reweighted
/// least squares).
class StereoRotation {
 public:
  /// `limit_px`: by which a match may be off its plane. What lies within half of it is left alone.
  StereoRotation(const Rigid3& second_from_first, double focal_px, double limit_px)
      : second_from_first_(second_from_first), focal_px_(focal_px), limit_px_(limit_px) {}

  /// The matches of one frame. `second_from_first`: in place of the file's, where the second image was taken
  /// at another moment.
  void add(const std::vector<RayPair>& pairs, const Rigid3& second_from_first);
  void add(const std::vector<RayPair>& pairs) { add(pairs, second_from_first_); }

  /// Whether the file's rotation would leave most matches off their planes, and this one does not.
  bool isFound() const { return found_; }
  /// theta, rad; zero until it is found.
  Vec3 turn() const { return found_ ? turn_ : Vec3::Zero(); }

 private:
  /// error_px = e(0), slope = -de/dtheta: small turns are linear.
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
