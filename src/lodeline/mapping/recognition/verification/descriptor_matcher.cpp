#include "lodeline/mapping/recognition/verification/descriptor_matcher.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <opencv2/core.hpp>
#include <set>

namespace lodeline {
namespace {

/// Bits in which descriptors of one point may differ. Those of different points differ in about 112.
constexpr int kMostBits = 68;
/// Distance of the nearest descriptor relative to that of the next one, for different points.
constexpr double kMostOfNext = 0.93;
/// Distance beyond all others.
constexpr int kOutOfReach = kDescriptorBits + 1;

cv::Mat matrixOf(const MapKeyframe& keyframe) {
  constexpr int kBytes = kDescriptorBits / 8;
  cv::Mat rows(static_cast<int>(keyframe.features.size()), kBytes, CV_8U);
  for (int i = 0; i < rows.rows; ++i) {
    const auto& bits = keyframe.features[static_cast<size_t>(i)].descriptor.bits;
    std::copy_n(reinterpret_cast<const uint8_t*>(bits.data()), kBytes, rows.ptr<uint8_t>(i));
  }
  return rows;
}

/// Directions in which a prediction expects points.
class SearchCone {
 public:
  explicit SearchCone(const LoopPrediction& prediction) : old_from_new_(prediction.old_from_new) {
    const auto widest = [](const Mat3& covariance) {
      return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvalues().z()));
    };
    position_sigma_m_ = widest(prediction.covariance.topLeftCorner<3, 3>());
    rotation_sigma_rad_ = widest(prediction.covariance.bottomRightCorner<3, 3>());
  }

  /// Largest angle at which a point at a distance may appear from where it is predicted; pi if there is no
  /// useful limit.
  double halfAngle_rad(double distance_m) const {
    constexpr double kSigmas = 3.5, kWidest_rad = 0.35, kRays_rad = 0.01;
    const double angle_rad =
        kSigmas * std::hypot(rotation_sigma_rad_, position_sigma_m_ / distance_m) + kRays_rad;
    return angle_rad < kWidest_rad ? angle_rad : std::numbers::pi;
  }
  const Rigid3& oldFromNew() const { return old_from_new_; }
  /// Whether it is of use for points at the distance of a usual scene.
  bool isNarrow(double distance_m) const { return halfAngle_rad(distance_m) < std::numbers::pi; }

 private:
  Rigid3 old_from_new_;
  double position_sigma_m_ = 0.0, rotation_sigma_rad_ = 0.0;
};

/// A feature's ray, and its position as the other keyframe should see it.
struct Placed {
  Vec3 origin_B, bearing_B;
  std::optional<Vec3> point_in_other;
  double halfangle_rad = std::numbers::pi, cosine = -1.0;
};

std::vector<Placed> placed(const MapKeyframe& keyframe, const Rigid3& other_from_this,
                           const SearchCone& cone) {
  std::vector<Placed> result;
  for (const MapFeature& feature : keyframe.features) {
    Placed& place = result.emplace_back();
    place.origin_B = feature.rays.front().origin_B;
    place.bearing_B = feature.rays.front().bearing_B;
    if (!feature.point_B) continue;
    place.point_in_other = other_from_this * *feature.point_B;
    place.halfangle_rad = cone.halfAngle_rad((*feature.point_B - place.origin_B).norm());
    place.cosine = std::cos(place.halfangle_rad);
  }
  return result;
}

/// Half the angle of the cone in which a pair lies; empty where it does not, or cannot be placed.
std::optional<double> reach_rad(const Placed& in_old, const Placed& in_new) {
  const auto within = [](const Placed& seen, const Placed& ray) {
    const Vec3 line = *seen.point_in_other - ray.origin_B;
    return line.dot(ray.bearing_B) >= seen.cosine * line.norm();
  };
  if (in_old.point_in_other)
    return within(in_old, in_new) ? std::optional(in_old.halfangle_rad) : std::nullopt;
  if (in_new.point_in_other)
    return within(in_new, in_old) ? std::optional(in_new.halfangle_rad) : std::nullopt;
  return std::nullopt;
}

/// Sets distances of pairs out of the prediction's reach to kOutOfReach, and stores the reach of the others.
cv::Mat restrict(const MapKeyframe& old_keyframe, const MapKeyframe& new_keyframe, const SearchCone& cone,
                 cv::Mat* distances) {
  cv::Mat reaches(distances->size(), CV_32F, cv::Scalar(std::numbers::pi));
  const auto in_old = placed(old_keyframe, cone.oldFromNew().inverse(), cone);
  const auto in_new = placed(new_keyframe, cone.oldFromNew(), cone);
  for (int i = 0; i < distances->rows; ++i) {
    for (int j = 0; j < distances->cols; ++j) {
      if (distances->at<int>(i, j) > kMostBits) continue;
      const auto reach = reach_rad(in_old[static_cast<size_t>(i)], in_new[static_cast<size_t>(j)]);
      if (reach) {
        reaches.at<float>(i, j) = static_cast<float>(*reach);
      } else {
        distances->at<int>(i, j) = kOutOfReach;
      }
    }
  }
  return reaches;
}

/// Index of the smallest element; the first one of equals.
int nearest(int count, const auto& distance) {
  int best = 0;
  for (int i = 1; i < count; ++i)
    if (distance(i) < distance(best)) best = i;
  return best;
}

/// Whether two features show one point: the same track, or positions that agree. In a merged keyframe, a
/// point occurs as often as its descriptors differ.
bool isOnePoint(const MapFeature& a, const MapFeature& b) {
  constexpr double kSamePlace = 0.02;  // relative to the distance
  if (a.track >= 0 && a.track == b.track) return true;
  if (!a.point_B || !b.point_B) return false;
  const double reach_m = kSamePlace * (*a.point_B - a.rays.front().origin_B).norm();
  return (*a.point_B - *b.point_B).squaredNorm() < reach_m * reach_m;
}

/// Whether the nearest element is clearly nearer than any of another point.
bool isDistinct(int best, int count, const auto& distance, const std::vector<MapFeature>& features) {
  const MapFeature& nearest = features[static_cast<size_t>(best)];
  for (int i = 0; i < count; ++i) {
    if (i != best && distance(best) > kMostOfNext * distance(i) &&
        !isOnePoint(nearest, features[static_cast<size_t>(i)]))
      return false;
  }
  return true;
}

/// Keeps the best match of each track.
void keepOneOfEachTrack(const MapKeyframe& old_keyframe, const MapKeyframe& new_keyframe,
                        std::vector<DescriptorMatch>* matches) {
  std::set<TrackId> old_tracks, new_tracks;
  std::erase_if(*matches, [&](const DescriptorMatch& match) {
    const TrackId in_old = old_keyframe.features[static_cast<size_t>(match.features.old_feature)].track;
    const TrackId in_new = new_keyframe.features[static_cast<size_t>(match.features.new_feature)].track;
    if ((in_old >= 0 && old_tracks.count(in_old)) || (in_new >= 0 && new_tracks.count(in_new))) return true;
    old_tracks.insert(in_old);
    new_tracks.insert(in_new);
    return false;
  });
}

}  // namespace

std::vector<DescriptorMatch> matchDescriptors(const MapKeyframe& old_keyframe,
                                              const MapKeyframe& new_keyframe,
                                              const std::optional<LoopPrediction>& prediction) {
  if (old_keyframe.features.empty() || new_keyframe.features.empty()) return {};
  cv::Mat distances;
  cv::batchDistance(matrixOf(old_keyframe), matrixOf(new_keyframe), distances, CV_32S, cv::noArray(),
                    cv::NORM_HAMMING);
  cv::Mat reaches;
  if (prediction) {
    constexpr double kFarScene_m = 10.0;
    const SearchCone cone(*prediction);
    if (cone.isNarrow(kFarScene_m)) reaches = restrict(old_keyframe, new_keyframe, cone, &distances);
  }
  std::vector<int> nearest_old;
  for (int j = 0; j < distances.cols; ++j)
    nearest_old.push_back(nearest(distances.rows, [&](int i) { return distances.at<int>(i, j); }));

  std::vector<DescriptorMatch> matches;
  for (int i = 0; i < distances.rows; ++i) {
    const auto to_new = [&](int k) { return distances.at<int>(i, k); };
    const int j = nearest(distances.cols, to_new);
    if (to_new(j) > kMostBits || nearest_old[static_cast<size_t>(j)] != i) continue;
    const auto to_old = [&](int k) { return distances.at<int>(k, j); };
    if (!isDistinct(j, distances.cols, to_new, new_keyframe.features) ||
        !isDistinct(i, distances.rows, to_old, old_keyframe.features)) {
      continue;
    }
    const double searched_rad =
        reaches.empty() ? std::numbers::pi : static_cast<double>(reaches.at<float>(i, j));
    matches.push_back({{i, j}, to_new(j), searched_rad});
  }
  std::stable_sort(matches.begin(), matches.end(), [](const DescriptorMatch& a, const DescriptorMatch& b) {
    return a.distance < b.distance;
  });
  keepOneOfEachTrack(old_keyframe, new_keyframe, &matches);
  return matches;
}

}  // namespace lodeline
