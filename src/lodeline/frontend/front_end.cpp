#include "lodeline/frontend/front_end.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/detection/mask.h"
#include "lodeline/util/settings/option_check.h"

namespace lodeline {
namespace {

std::vector<std::shared_ptr<const Camera>> makeCameras(const Rig& rig) {
  if (rig.cameras.empty()) throw InputError("the rig has no camera; give a calibration of at least cam0");
  std::vector<std::shared_ptr<const Camera>> cameras;
  for (const CameraCalibration& calibration : rig.cameras) cameras.push_back(makeCamera(calibration));
  return cameras;
}

bool isMasked(const cv::Mat& mask, const Eigen::Vector2f& pixel) {
  return !mask.empty() && mask.at<uint8_t>(static_cast<int>(std::lround(pixel.y())),
                                           static_cast<int>(std::lround(pixel.x()))) == 0;
}

}  // namespace

void FrontEndOptions::check() const {
  OptionCheck("front_end")
      .atLeast("pyramid_levels", pyramid_levels, 1)
      .atLeast("max_tracks", detector.max_tracks, 1)
      .positive("min_distance_px", detector.min_distance_px)
      .notNegative("min_gradient_grey_per_px", detector.min_gradient_grey_per_px)
      .positive("max_forward_backward_px", tracker.max_forward_backward_px)
      .positive("max_stereo_epipolar_px", stereo.max_epipolar_px)
      .positive("min_depth_m", stereo.min_depth_m)
      .positive("max_epipolar_px", consensus.max_error_px)
      .atLeast("hypotheses", consensus.hypotheses, 1)
      .positive("max_gap_s", max_gap_s)
      .positive("sigma_px", sigma_px);
}

FrontEnd::FrontEnd(const Rig& rig, const FrontEndOptions& options)
    : options_(options),
      cameras_(makeCameras(rig)),
      body_from_camera_(rig.cameras.front().body_from_camera.rotation),
      tracker_(cameras_.front(), options.tracker),
      detector_(options.detector),
      static_image_masks_(cameras_.size(), StaticImageMask(options.static_image_mask)) {
  options.check();
  for (const CameraCalibration& calibration : rig.cameras) masks_.push_back(loadMask(calibration));
  for (size_t i = 1; i < cameras_.size(); ++i) {
    matchers_.emplace_back(cameras_.front(), cameras_[i], options.stereo);
  }
}

void FrontEnd::check(Time time, const std::vector<cv::Mat>& images) const {
  if (images.size() != cameras_.size()) {
    throw InputError(fmt::format("frame at {} ns: {} images for {} cameras", time.nanoseconds(),
                                 images.size(), cameras_.size()));
  }
  for (size_t i = 0; i < images.size(); ++i) {
    const CameraCalibration& c = cameras_[i]->calibration();
    const cv::Mat& image = images[i];
    if (image.empty()) continue;
    if (image.cols != c.width_px || image.rows != c.height_px) {
      throw InputError(
          fmt::format("camera '{}', image at {} ns: {} x {} px, but the calibration says {} x {} px; use the "
                      "calibration that belongs to these images",
                      c.name, time.nanoseconds(), image.cols, image.rows, c.width_px, c.height_px));
    }
    if (image.type() != CV_8UC1) {
      throw InputError(
          fmt::format("camera '{}', image at {} ns: not an 8-bit grey image", c.name, time.nanoseconds()));
    }
  }
}

FrameTracks FrontEnd::process(Time time, const std::vector<cv::Mat>& images,
                              const Quat& previous_from_current_B, const Quat& alternative_B,
                              const RigMotion& motion) {
  check(time, images);
  constexpr double kGap = 1.5;  // in usual intervals
  statistics_ = {};
  previous_from_current_B_ = (previous_from_current_B_ * previous_from_current_B).normalized();
  alternative_B_ = (alternative_B_ * alternative_B).normalized();
  if (images.front().empty()) {
    statistics_.missing = true;
    return {time};
  }

  ImagePyramid current = pyramid(images.front());
  const bool was_faint = faint_;
  updateQuality(current);
  if (faint_ != was_faint) current = pyramid(images.front());
  static_image_masks_.front().add(time, current);
  const double interval_s = (time - previous_time_).seconds();
  if (interval_s > options_.max_gap_s) {
    statistics_.lost = static_cast<int>(tracks_.size());
    tracks_.clear();
  }
  // After a gap the predictions by earlier images are not valid.
  if (interval_s > kGap * previous_interval_s_) {
    for (Track& track : tracks_) track.prediction_error_px.reset();
  }
  const auto ofCamera = [&](const Quat& previous_from_current) {
    return (body_from_camera_.conjugate() * previous_from_current.conjugate() * body_from_camera_)
        .toRotationMatrix();
  };
  follow(current, ofCamera(previous_from_current_B_), ofCamera(alternative_B_));
  detect(current);
  for (size_t m = 0; m < matchers_.size(); ++m) matchers_[m].setMotion(motion, m + 1);
  matchOthers(time, current, images);

  previous_ = std::move(current);
  previous_time_ = time;
  previous_interval_s_ = interval_s;
  previous_from_current_B_ = alternative_B_ = Quat::Identity();
  return observations(time);
}

void FrontEnd::forgetTracks() {
  statistics_.lost += static_cast<int>(tracks_.size());
  tracks_.clear();
}

ImagePyramid FrontEnd::pyramid(const cv::Mat& image) const {
  constexpr int kUsualSidePx = 3, kFaintSidePx = 7;
  return ImagePyramid(image, options_.pyramid_levels, faint_ ? kFaintSidePx : kUsualSidePx);
}

void FrontEnd::updateQuality(const ImagePyramid& current) {
  // The threshold for leaving the state differs from that for entering it, so that patches of two images stay
  // comparable.
  constexpr double kHysteresis = 1.3, kNoiseHysteresis = 0.93;
  statistics_.image = assess(current);
  const bool faint =
      statistics_.image.texture_grey < options_.faint_texture_grey * (faint_ ? kHysteresis : 1.0);
  const bool noisy =
      statistics_.image.sharpness > options_.noisy_sharpness * (faint_ ? kNoiseHysteresis : 1.0);
  faint_ = faint || noisy;
}

FrontEnd::Followed FrontEnd::follow(std::vector<Track> tracks, const ImagePyramid& current,
                                    const Mat3& current_from_previous_C) const {
  Followed followed;
  followed.tracks.reserve(tracks.size());
  for (Track& track : tracks) {
    const auto bearing = cameras_.front()->unproject(track.warp.position.cast<double>());
    if (!bearing || !tracker_.follow(previous_, current, current_from_previous_C, track) ||
        isHidden(0, track.warp.position))
      continue;
    followed.tracks.push_back(std::move(track));
    followed.previous_bearings.push_back(*bearing);
  }
  return followed;
}

void FrontEnd::follow(const ImagePyramid& current, const Mat3& current_from_previous_C,
                      const Mat3& alternative_C) {
  // Smaller differences are within the reach of the tracker.
  constexpr double kReach_rad = 0.05;
  const size_t before = tracks_.size();
  const bool differ =
      Eigen::AngleAxisd(Mat3(current_from_previous_C.transpose() * alternative_C)).angle() > kReach_rad;
  std::vector<Track> again;
  if (differ) again = tracks_;
  Followed followed = follow(std::move(tracks_), current, current_from_previous_C);
  if (differ && 2 * followed.tracks.size() < before) {
    Followed otherwise = follow(std::move(again), current, alternative_C);
    if (otherwise.tracks.size() > followed.tracks.size()) followed = std::move(otherwise);
  }
  tracks_ = std::move(followed.tracks);
  statistics_.lost += static_cast<int>(before - tracks_.size());
  rejectOutliers(followed.previous_bearings, current_from_previous_C, alternative_C);
  rejectCrowded();
  statistics_.kept = static_cast<int>(tracks_.size());
}

void FrontEnd::rejectOutliers(const std::vector<Vec3>& previous_bearings, const Mat3& current_from_previous_C,
                              const Mat3& alternative_C) {
  const Camera& camera = *cameras_.front();
  std::vector<Vec3> bearings;
  for (const Track& track : tracks_) {
    // The tracker guarantees that the pixel is in the image; at the corners there may still be no ray.
    bearings.push_back(camera.unproject(track.warp.position.cast<double>()).value_or(Vec3::Zero()));
  }
  const auto agreeing = [&](const Mat3& rotation) {
    return twoPointRansac(previous_bearings, bearings, rotation, camera.focalLengthsOnAxis_px().x(),
                          options_.consensus);
  };
  const auto count = [](const std::vector<bool>& which) {
    return std::count(which.begin(), which.end(), true);
  };
  std::vector<bool> agrees = agreeing(current_from_previous_C);
  if (2 * count(agrees) < std::ssize(agrees) && alternative_C != current_from_previous_C) {
    const std::vector<bool> otherwise = agreeing(alternative_C);
    if (count(otherwise) > count(agrees)) agrees = otherwise;
  }
  size_t i = 0;
  const size_t removed = std::erase_if(tracks_, [&](const Track&) {
    const bool good = agrees[i] && !bearings[i].isZero();
    ++i;
    return !good;
  });
  statistics_.rejected += static_cast<int>(removed);
}

void FrontEnd::rejectCrowded() {
  // Two tracks that are very close track the same point; the older one is more accurate.
  const auto distance = static_cast<float>(0.5 * options_.detector.min_distance_px);
  std::vector<Eigen::Vector2f> kept;
  const size_t removed = std::erase_if(tracks_, [&](const Track& track) {
    for (const Eigen::Vector2f& other : kept) {
      if ((other - track.warp.position).squaredNorm() < distance * distance) return true;
    }
    kept.push_back(track.warp.position);
    return false;
  });
  statistics_.rejected += static_cast<int>(removed);
}

bool FrontEnd::isHidden(size_t camera, const Eigen::Vector2f& pixel) const {
  return isMasked(masks_[camera], pixel) || isMasked(static_image_masks_[camera].mask(), pixel);
}

void FrontEnd::detect(const ImagePyramid& current) {
  if (static_cast<int>(tracks_.size()) >= options_.detector.max_tracks) return;
  std::vector<Eigen::Vector2f> occupied;
  for (const Track& track : tracks_) occupied.push_back(track.warp.position);
  cv::Mat visible = masks_.front();
  const cv::Mat& moving = static_image_masks_.front().mask();
  if (visible.empty()) {
    visible = moving;
  } else if (!moving.empty()) {
    visible = visible & moving;
  }
  for (const Eigen::Vector2f& pixel : detector_.detect(current, visible, occupied, faint_)) {
    if (static_cast<int>(tracks_.size()) >= options_.detector.max_tracks) break;
    Track track;
    track.warp.position = pixel;
    if (!cameras_.front()->unproject(pixel.cast<double>())) continue;
    auto looks = PatchTemplate::extract(current, pixel, options_.pyramid_levels);
    if (!looks) continue;
    track.id = next_id_++;
    track.current = *looks;
    track.reference = std::move(*looks);
    track.matches.resize(matchers_.size());
    tracks_.push_back(std::move(track));
    ++statistics_.created;
  }
}

void FrontEnd::matchOthers(Time time, const ImagePyramid& current, const std::vector<cv::Mat>& images) {
  for (size_t m = 0; m < matchers_.size(); ++m) {
    const cv::Mat& image = images[m + 1];
    if (image.empty()) {
      for (Track& track : tracks_) track.matches[m].reset();
      continue;
    }
    const ImagePyramid other = pyramid(image);
    static_image_masks_[m + 1].add(time, other);
    matchOther(m, current, other);
  }
  for (const Track& track : tracks_) {
    statistics_.matched += std::any_of(track.matches.begin(), track.matches.end(),
                                       [](const auto& match) { return match.has_value(); })
                               ? 1
                               : 0;
  }
}

void FrontEnd::matchOther(size_t m, const ImagePyramid& current, const ImagePyramid& other) {
  std::vector<std::optional<StereoCandidate>> candidates;
  std::vector<RayPair> rays;
  for (const Track& track : tracks_) {
    auto candidate = matchers_[m].find(current, other, track.matches[m], track);
    if (candidate && isHidden(m + 1, candidate->warp.position)) candidate.reset();
    if (candidate) rays.push_back(candidate->rays);
    candidates.push_back(std::move(candidate));
  }
  matchers_[m].learn(rays);
  for (size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].matches[m].reset();
    if (!candidates[i]) continue;
    const auto inverse_depth = matchers_[m].accept(candidates[i]->rays);
    if (!inverse_depth) continue;
    tracks_[i].inverse_depth_per_m = inverse_depth;
    tracks_[i].matches[m] = candidates[i]->warp;
  }
}

FrameTracks FrontEnd::observations(Time time) const {
  FrameTracks result{time};
  for (const StereoMatcher& matcher : matchers_)
    result.camera_rotations.push_back(matcher.rotationCorrection());
  for (const Track& track : tracks_) {
    const Vec2 pixel = track.warp.position.cast<double>();
    const auto first = cameras_.front()->viewRay(pixel);
    if (first) {
      const Vec3 origin_C = first->fromNearestPoint().origin_C;
      result.observations.push_back({track.id, 0, pixel, first->direction_C, options_.sigma_px, origin_C});
    }
    for (size_t m = 0; m < track.matches.size(); ++m) {
      if (!track.matches[m]) continue;
      const Vec2 matched = track.matches[m]->position.cast<double>();
      const auto ray = cameras_[m + 1]->viewRay(matched);
      if (!ray) continue;
      const Vec3 at_frame = first ? matchers_[m].rayAtFrame(rayPair(*first, *ray), *track.inverse_depth_per_m)
                                  : ray->direction_C;
      result.observations.push_back({track.id, static_cast<int>(m) + 1, matched, at_frame, options_.sigma_px,
                                     ray->fromNearestPoint().origin_C});
    }
  }
  return result;
}

}  // namespace lodeline
