#include "lodeline/mapping/session/loops/cloud_loops.h"

#include <algorithm>

#include "lodeline/mapping/cloud/in_and_out.h"
#include "lodeline/mapping/cloud/local_cloud.h"
#include "lodeline/mapping/cloud/register_clouds.h"

namespace lodeline {
namespace {

/// Copies the keyframes along the path near one of them, with their features. `middle` receives its index in
/// the copy.
std::vector<MapKeyframe> stretchAround(const std::vector<MapKeyframe>& keyframes, size_t index,
                                       const std::function<std::vector<MapFeature>(KeyframeId)>& features,
                                       size_t* middle) {
  const double half_m = LocalCloudOptions{}.path_half_m;
  const auto step_m = [&](size_t i) {
    return (keyframes[i + 1].odom_from_body.translation - keyframes[i].odom_from_body.translation).norm();
  };
  size_t first = index, last = index;
  for (double path_m = 0.0; first > 0 && path_m + step_m(first - 1) <= half_m; --first)
    path_m += step_m(first - 1);
  for (double path_m = 0.0; last + 1 < keyframes.size() && path_m + step_m(last) <= half_m; ++last)
    path_m += step_m(last);
  std::vector<MapKeyframe> stretch(keyframes.begin() + static_cast<std::ptrdiff_t>(first),
                                   keyframes.begin() + static_cast<std::ptrdiff_t>(last) + 1);
  for (MapKeyframe& keyframe : stretch) keyframe.features = features(keyframe.id);
  *middle = index - first;
  return stretch;
}

}  // namespace

std::vector<Loop> cloudLoops(const std::vector<MapKeyframe>& keyframes,
                             const std::function<std::vector<MapFeature>(KeyframeId)>& features,
                             const Vec3& view_B) {
  InAndOutOptions options;
  options.view_B = view_B;
  std::vector<Loop> loops;
  for (const CloudPair& pair : inAndOutCandidates(keyframes, options)) {
    // Where both look the same way, descriptors find the loop with far better accuracy.
    if (!pair.looks_back) continue;
    size_t old_middle = 0, new_middle = 0;
    const std::vector<MapKeyframe> old_stretch =
        stretchAround(keyframes, pair.old_index, features, &old_middle);
    const std::vector<MapKeyframe> new_stretch =
        stretchAround(keyframes, pair.new_index, features, &new_middle);
    loops.push_back(registerClouds(cloudOfKeyframes(old_stretch, old_middle),
                                   cloudOfKeyframes(new_stretch, new_middle), pair.old_from_new,
                                   pair.covariance)
                        .loop);
  }
  std::sort(loops.begin(), loops.end(),
            [](const Loop& a, const Loop& b) { return a.new_keyframe < b.new_keyframe; });
  return loops;
}

}  // namespace lodeline
