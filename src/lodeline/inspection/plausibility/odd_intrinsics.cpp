#include "lodeline/inspection/plausibility/odd_intrinsics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lodeline/cameras/camera.h"
#include "lodeline/cameras/camera_model.h"
#include "lodeline/inspection/survey/camera_words.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Full angle between the centres of the left and right edges.
std::optional<double> widthAngle_deg(const CameraCalibration& calibration) {
  const std::shared_ptr<const Camera> camera = makeCamera(calibration);
  const double row = 0.5 * calibration.height_px;
  const auto left = camera->unproject(Vec2(0.0, row));
  const auto right = camera->unproject(Vec2(calibration.width_px - 1.0, row));
  if (!left || !right) return std::nullopt;
  return kDegreesPerRadian * std::acos(std::clamp(left->dot(*right), -1.0, 1.0));
}

/// The four numbers that every camera model has, px.
struct Intrinsics {
  double fx, fy, cx, cy;
};

/// Whether the principal point is within `share` of the image's size from its centre.
bool isNearCentre(const Intrinsics& in, const Vec2& size_px, double share) {
  return std::abs(in.cx / size_px.x() - 0.5) < share && std::abs(in.cy / size_px.y() - 0.5) < share;
}

/// Whether four numbers are those of a common lens on square pixels.
bool areCommon(const Intrinsics& in, const Vec2& size_px) {
  constexpr double kNearCentre = 0.1, kSquare = 1.05, kShortest = 0.2, kLongest = 4.0;
  return isNearCentre(in, size_px, kNearCentre) &&
         std::max(in.fx, in.fy) < kSquare * std::min(in.fx, in.fy) && in.fx > kShortest * size_px.x() &&
         in.fx < kLongest * size_px.x();
}

/// The order in which four numbers are common ones, where they are not in the right order.
std::string otherOrder(const Intrinsics& in, const Vec2& size_px) {
  if (areCommon(in, size_px)) return {};
  if (areCommon({in.cx, in.cy, in.fx, in.fy}, size_px)) return "cx, cy, fx, fy";
  if (areCommon({in.fx, in.cx, in.fy, in.cy}, size_px)) return "fx, cx, fy, cy";
  if (areCommon({in.fx, in.fy, in.cy, in.cx}, size_px)) return "fx, fy, cy, cx";
  return {};
}

/// The image's size over that for which the principal point is the centre, where width and height agree and
/// it is not near 1.
std::optional<double> otherSize(const Intrinsics& in, const Vec2& size_px) {
  constexpr double kFar = 1.25, kSame = 1.1;
  const Vec2 ratio = 0.5 * size_px.cwiseQuotient(Vec2(in.cx, in.cy));
  const double scale = 0.5 * (ratio.x() + ratio.y());
  if (ratio.maxCoeff() > kSame * ratio.minCoeff() || (scale < kFar && scale > 1.0 / kFar))
    return std::nullopt;
  return scale;
}

/// Tangential distortion beyond that of lenses, which are centred to a few thousandths, in words.
std::string largeTangential(const CameraCalibration& camera) {
  constexpr double kLargest = 0.02;
  const CameraModel& model = makeCamera(camera)->model();
  if (!model.tangential_at || camera.distortion.size() < *model.tangential_at + 2) return {};
  const double p1 = camera.distortion[*model.tangential_at], p2 = camera.distortion[*model.tangential_at + 1];
  if (std::max(std::abs(p1), std::abs(p2)) < kLargest) return {};
  const auto count = static_cast<std::ptrdiff_t>(camera.distortion.size());
  return fmt::format(
      "the tangential coefficients p1 = {:g} and p2 = {:g} are larger than those of lenses: are the "
      "coefficients in the order {}?",
      p1, p2,
      fmt::join(
          model.parameters.begin(),
          model.parameters.begin() + std::min(count, static_cast<std::ptrdiff_t>(model.parameters.size())),
          ", "));
}

}  // namespace

OddIntrinsics oddIntrinsics(const CameraCalibration& camera) {
  if (!isCalibrated(camera)) return {};
  const Intrinsics given = {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px};
  const Vec2 size_px(camera.width_px, camera.height_px);
  const std::string order = otherOrder(given, size_px);
  if (!order.empty()) {
    return {
        fmt::format("[{:g}, {:g}, {:g}, {:g}] are not in the order fx, fy, cx, cy: as {} they fit an image "
                    "of {} x {} px; write them as fx, fy, cx, cy",
                    given.fx, given.fy, given.cx, given.cy, order, camera.width_px, camera.height_px),
        true};
  }
  if (const std::optional<double> scale = otherSize(given, size_px)) {
    return {
        fmt::format("the principal point ({:.0f}, {:.0f}) px is the centre of images of {:.0f} x {:.0f} px, "
                    "but the images have {} x {} px: the calibration seems to be of another size; multiply "
                    "fx, fy, cx and cy by {:.3g}, or calibrate at the recorded size",
                    given.cx, given.cy, size_px.x() / *scale, size_px.y() / *scale, camera.width_px,
                    camera.height_px, *scale),
        true};
  }
  if (!isNearCentre(given, size_px, 0.2)) {
    return {fmt::format("the principal point ({:.0f}, {:.0f}) px lies far from the centre of {} x {} px",
                        camera.cx_px, camera.cy_px, camera.width_px, camera.height_px)};
  }
  if (std::max(camera.fx_px, camera.fy_px) > 1.1 * std::min(camera.fx_px, camera.fy_px)) {
    return {fmt::format("the focal lengths {:.1f} and {:.1f} px differ by more than 10 %: pixels are square",
                        camera.fx_px, camera.fy_px)};
  }
  if (const std::string tangential = largeTangential(camera); !tangential.empty()) return {tangential};
  const std::optional<double> angle_deg = widthAngle_deg(camera);
  if (!angle_deg) return {"the distortion is not invertible within the image"};
  if (*angle_deg < 15.0)
    return {fmt::format("the view is only {:.0f} deg wide; is the focal length right?", *angle_deg)};
  return {};
}

}  // namespace lodeline
