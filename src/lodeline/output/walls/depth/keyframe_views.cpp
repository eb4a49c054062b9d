#include "lodeline/output/walls/depth/keyframe_views.h"

#include <cmath>

#include "lodeline/output/survey/map/pose_at.h"

namespace lodeline {

std::optional<KeyframeView> KeyframeViews::next() {
  while (std::optional<PendingImage> image = source_.nextImage(0)) {
    const Time time = timeOf(0, *image);
    const std::optional<Rigid3> pose = poseAt(trajectory_, time);
    if (!pose || !isFar(*pose)) continue;
    KeyframeView view{number_, time, *pose, {std::move(*image)}};
    if (cameras_.size() > 1) {
      std::optional<PendingImage> partner = partnerAt(time);
      if (!partner) continue;
      view.images.push_back(std::move(*partner));
    }
    last_ = *pose;
    ++number_;
    return view;
  }
  return std::nullopt;
}

std::optional<PendingImage> KeyframeViews::partnerAt(Time time) {
  constexpr double kTolerance_s = 3e-3;
  while (true) {
    if (!partner_) partner_ = source_.nextImage(1);
    if (!partner_) return std::nullopt;
    const double ahead_s = (timeOf(1, *partner_) - time).seconds();
    if (ahead_s > kTolerance_s) return std::nullopt;
    std::optional<PendingImage> candidate = std::move(partner_);
    partner_.reset();
    if (std::abs(ahead_s) <= kTolerance_s) return candidate;
  }
}

bool KeyframeViews::isFar(const Rigid3& map_from_body) const {
  if (!last_) return true;
  const Rigid3 change = last_->inverse() * map_from_body;
  return change.translation.norm() >= steps_.step_m ||
         2.0 * std::acos(std::min(1.0, std::abs(change.rotation.w()))) >= steps_.step_rad;
}

}  // namespace lodeline
