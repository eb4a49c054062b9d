#include "lodeline/inspection/survey/stereo_survey.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/detection/corner_detector.h"
#include "lodeline/frontend/detection/mask.h"
#include "lodeline/frontend/stereo/stereo_rotation.h"

namespace lodeline {
namespace {

/// Images within this time difference count as simultaneous, s: the motion of a rig in that time is
/// negligible here.
constexpr double kTogether_s = 25e-3;
constexpr int64_t kMostImages = 16;
/// Distance from the epipolar line beyond the errors of real calibrations with a port; rad.
constexpr double kOffLine_rad = 0.02;
/// Parallax at which the side of the camera is certain even with such a calibration.
constexpr double kParallax_rad = 0.02;

/// A complete hypothesis: which camera took which image, and the second camera's pose in the first.
struct Arrangement {
  StereoHypothesis hypothesis;
  const Camera* first;
  const Camera* second;
  Rigid3 first_from_second;
};

using Arrangements = std::array<Arrangement, 5>;

Arrangements arrangements(const Camera& first, const Camera& second) {
  const Rigid3& body_from_first = first.calibration().body_from_camera;
  const Rigid3& body_from_second = second.calibration().body_from_camera;
  const Rigid3 given = body_from_first.inverse() * body_from_second;
  using enum StereoHypothesis;
  return {{{AsCalibrated, &first, &second, given},
           {ImagesExchanged, &second, &first, given.inverse()},
           {ExtrinsicsExchanged, &first, &second, given.inverse()},
           {ExtrinsicsInverted, &first, &second, body_from_first * body_from_second.inverse()},
           {BaselineReversed, &first, &second, Rigid3(given.rotation, -given.translation)}}};
}

enum class PointVerdict { NoParallax, Agrees, Disagrees };

/// From the depth z of a point on ray f1 that the second camera observes on ray f2, p = z f1 = t + s R f2:
/// z |f1 x R f2|^2 = (t x R f2) . (f1 x R f2).
PointVerdict judge(const PointPair& point, const Arrangement& arrangement) {
  const std::optional<Vec3> ray = arrangement.first->unproject(point.first);
  const std::optional<Vec3> other = arrangement.second->unproject(point.second);
  if (!ray || !other) return PointVerdict::NoParallax;
  const Vec3 turned = arrangement.first_from_second.rotation * *other;
  const Vec3 across = ray->cross(turned);
  const Vec3 way = arrangement.first_from_second.translation.normalized();
  const Vec3 normal = way.cross(*ray);
  if (across.norm() < kParallax_rad || normal.norm() < 0.1) return PointVerdict::NoParallax;
  const bool is_on_line = std::abs(turned.dot(normal.normalized())) < kOffLine_rad;
  const bool is_in_front = way.cross(turned).dot(across) > 0.0;
  return is_on_line && is_in_front ? PointVerdict::Agrees : PointVerdict::Disagrees;
}

double turnOf(const Arrangement& as_calibrated, const std::vector<PointPair>& points) {
  constexpr double kLimit_px = 2.0;  // of stereo matches in a run
  const Rigid3 second_from_first = as_calibrated.first_from_second.inverse();
  StereoRotation rotation(second_from_first, as_calibrated.second->focalLengthsOnAxis_px().x(), kLimit_px);
  std::vector<RayPair> pairs;
  for (const PointPair& point : points) {
    const std::optional<Vec3> first = as_calibrated.first->unproject(point.first);
    const std::optional<Vec3> second = as_calibrated.second->unproject(point.second);
    if (!first || !second) continue;
    const std::optional<Vec3> normal = epipolarNormal(second_from_first, *first);
    if (normal && std::abs(normal->dot(*second)) < kOffLine_rad) pairs.push_back({*first, *second});
  }
  rotation.add(pairs);
  return rotation.turn().norm();
}

cv::Mat grey(const PendingImage& image, const CameraCalibration& calibration) {
  cv::Mat pixels = image.load().image;
  return pixels.cols == calibration.width_px && pixels.rows == calibration.height_px ? pixels : cv::Mat();
}

}  // namespace

std::vector<PointPair> matchStereo(const cv::Mat& first, const cv::Mat& second, const cv::Mat& mask) {
  constexpr int kLevels = 4;
  const CornerDetector detector{CornerDetectorOptions()};
  std::vector<cv::Point2f> corners;
  for (const Eigen::Vector2f& corner : detector.detect(ImagePyramid(first, kLevels), mask, {})) {
    corners.emplace_back(corner.x(), corner.y());
  }
  return followPoints(first, second, corners);
}

bool areCopies(const cv::Mat& first, const cv::Mat& second, const std::vector<PointPair>& points) {
  constexpr size_t kFewest = 20;
  constexpr double kSamePlace_px = 0.25, kNearlyAll = 0.9;
  constexpr double kSameBrightness_grey = 1.0;  // of a copy that was compressed anew
  if (points.size() < kFewest || first.size() != second.size()) return false;
  const auto at_same_place = std::count_if(points.begin(), points.end(), [&](const PointPair& point) {
    return (point.second - point.first).norm() < kSamePlace_px;
  });
  const double difference_grey = cv::norm(first, second, cv::NORM_L1) / static_cast<double>(first.total());
  return static_cast<double>(at_same_place) > kNearlyAll * static_cast<double>(points.size()) &&
         difference_grey < kSameBrightness_grey;
}

StereoSurvey compareStereo(const CameraCalibration& first, const CameraCalibration& second,
                           const std::vector<PointPair>& points) {
  StereoSurvey survey;
  const auto first_camera = makeCamera(first);
  const auto second_camera = makeCamera(second);
  const Arrangements all = arrangements(*first_camera, *second_camera);
  survey.baseline_m = all[0].first_from_second.translation.norm();
  if (!(survey.baseline_m > 0.0)) return survey;
  std::array<int, 5> agreeing{};
  for (const PointPair& point : points) {
    std::array<PointVerdict, 5> verdicts{};
    std::transform(all.begin(), all.end(), verdicts.begin(),
                   [&](const Arrangement& arrangement) { return judge(point, arrangement); });
    // All hypotheses are compared on the same points, so that none can win with only a few.
    if (std::count(verdicts.begin(), verdicts.end(), PointVerdict::NoParallax) > 0) continue;
    ++survey.points;
    for (size_t i = 0; i < all.size(); ++i) agreeing[i] += verdicts[i] == PointVerdict::Agrees ? 1 : 0;
  }
  if (survey.points == 0) return survey;
  const int best = *std::max_element(agreeing.begin(), agreeing.end());
  survey.agreement = static_cast<double>(agreeing[0]) / survey.points;
  survey.best_agreement = static_cast<double>(best) / survey.points;
  constexpr double kNearlyAll = 0.95;
  for (size_t i = 0; i < all.size(); ++i) {
    if (agreeing[i] >= kNearlyAll * best) survey.fitting.push_back(all[i].hypothesis);
  }
  survey.turn_rad = turnOf(all[0], points);
  return survey;
}

std::optional<StereoSurvey> surveyStereo(MeasurementSource* source, const StreamSummary& stream) {
  const CameraCalibration& first = source->rig().cameras[0];
  const CameraCalibration& second = source->rig().cameras[1];
  if (first.width_px != second.width_px || first.height_px != second.height_px) return std::nullopt;
  const cv::Mat mask = loadMask(first);
  const int64_t every = std::max<int64_t>(1, stream.readings / kMostImages);
  std::vector<PointPair> points;
  int images = 0, same = 0;
  std::optional<PendingImage> other = source->nextImage(1);
  for (int64_t index = 0; const std::optional<PendingImage> image = source->nextImage(0); ++index) {
    while (other && (image->time - other->time).seconds() > kTogether_s) other = source->nextImage(1);
    if (!other || (other->time - image->time).seconds() > kTogether_s || index % every != 0) continue;
    const cv::Mat left = grey(*image, first);
    const cv::Mat right = grey(*other, second);
    if (left.empty() || right.empty()) continue;
    ++images;
    const std::vector<PointPair> found = matchStereo(left, right, mask);
    points.insert(points.end(), found.begin(), found.end());
    same += areCopies(left, right, found) ? 1 : 0;
  }
  if (images == 0) return std::nullopt;
  StereoSurvey survey = compareStereo(first, second, points);
  survey.images = images;
  survey.same = same;
  return survey;
}

}  // namespace lodeline
