#include "lodeline/output/walls/dive_depths.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "lodeline/output/walls/depth/depth_jobs.h"

namespace lodeline {
namespace {

/// Consecutive keyframes without depths.
class BlindSpan {
 public:
  explicit BlindSpan(Time origin) : origin_(origin) {}

  void add(Time time, bool is_blind) {
    if (is_blind && !was_blind_) first_ = time;
    was_blind_ = is_blind;
    if (!is_blind) return;
    ++keyframes_;
    if ((time - first_).seconds() < longest_s_) return;
    longest_s_ = (time - first_).seconds();
    longest_first_ = first_;
  }

  void report(size_t keyframes, Diagnostics* diagnostics) const {
    if (keyframes_ == 0) return;
    diagnostics->report(
        5 * keyframes_ > keyframes ? Severity::Warning : Severity::Notice, "walls_blind",
        fmt::format(
            "{} of {} keyframes show no walls, longest from {:.1f} to {:.1f} s of the dive: too dark, "
            "too far, without texture, or silt",
            keyframes_, keyframes, (longest_first_ - origin_).seconds(),
            (longest_first_ - origin_).seconds() + longest_s_));
  }

 private:
  Time origin_, first_, longest_first_;
  bool was_blind_ = false;
  double longest_s_ = 0.0;
  size_t keyframes_ = 0;
};

/// Box about a keyframe's camera and points, and the tiles of its points.
DepthKeyframe located(const DepthJob& job, const DepthImage& image, const PinholeView& pinhole,
                      double tile_edge_m, std::set<std::array<int, 3>>* tiles) {
  constexpr int kStep_px = 4;
  DepthKeyframe keyframe{job.number, job.time, job.map_from_view, {}};
  for (int v = 0; v < image.depth.rows; v += kStep_px) {
    for (int u = 0; u < image.depth.cols; u += kStep_px) {
      const double depth_m = image.depth_m(u, v);
      if (depth_m <= 0.0) continue;
      const Vec3 point = job.map_from_view * (depth_m * pinhole.direction(u, v));
      keyframe.box.extend(point);
      const Eigen::Vector3i tile = (point / tile_edge_m).array().floor().cast<int>();
      tiles->insert({tile.x(), tile.y(), tile.z()});
    }
  }
  if (!keyframe.box.isEmpty()) keyframe.box.extend(job.map_from_view.translation);
  return keyframe;
}

}  // namespace

DiveDepths computeDepths(MeasurementSource& source, const std::vector<CameraCalibration>& cameras,
                         const Trajectory& trajectory_ENU, const DiveDepthOptions& options,
                         double tile_edge_m, const DepthStore& store, const WallProgress& progress,
                         Diagnostics* diagnostics) {
  constexpr size_t kAtOnce = 4;
  constexpr double kLeastShare = 0.02;
  const RectifiedView view(cameras, options.rectification);
  KeyframeViews views(source, cameras, trajectory_ENU, options.steps);
  DepthJobs jobs(views, view, cameras.size() > 1, options.depth);
  const Time begin = trajectory_ENU.poses.front().time, end = trajectory_ENU.poses.back().time;
  BlindSpan blind(begin);
  DiveDepths result;
  result.frames.pinhole = view.pinhole();
  result.frames.depths = [&store](size_t number) { return store.read(number); };
  while (result.complete) {
    std::vector<DepthJob> batch;
    while (batch.size() < kAtOnce) {
      auto job = jobs.next();
      if (!job) break;
      batch.push_back(std::move(*job));
    }
    if (batch.empty()) break;
    std::vector<DepthImage> images(batch.size());
    std::vector<uint8_t> is_new(batch.size(), 0);
    tbb::parallel_for(size_t{0}, batch.size(), [&](size_t i) {
      is_new[i] = store.has(batch[i].number) ? 0 : 1;
      images[i] = is_new[i] ? batch[i].compute() : store.read(batch[i].number);
      if (is_new[i]) store.write(batch[i].number, images[i]);
    });
    for (size_t i = 0; i < batch.size(); ++i) {
      blind.add(batch[i].time, images[i].share() < kLeastShare);
      result.computed += is_new[i];
      result.frames.keyframes.push_back(
          located(batch[i], images[i], view.pinhole(), tile_edge_m, &result.tiles));
    }
    const double span_s = std::max(1e-9, (end - begin).seconds());
    result.complete = progress("depths", (batch.back().time - begin).seconds() / span_s);
  }
  blind.report(result.frames.keyframes.size(), diagnostics);
  if (!result.frames.keyframes.empty())
    result.seconds = (result.frames.keyframes.back().time - result.frames.keyframes.front().time).seconds();
  return result;
}

}  // namespace lodeline
