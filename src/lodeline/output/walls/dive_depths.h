#pragma once

#include <functional>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/output/walls/depth/depth_store.h"
#include "lodeline/output/walls/depth/keyframe_views.h"
#include "lodeline/output/walls/fusion/tile_fusion.h"

namespace lodeline {

/// How far a step of `walls` is, for the user; `share` of 0 to 1. Returns whether to go on.
using WallProgress = std::function<bool(const char* stage, double share)>;

struct DiveDepthOptions {
  KeyframeSteps steps;
  RectificationOptions rectification;
  DepthImageOptions depth;
};

/// Depths of a dive.
struct DiveDepths {
  DepthKeyframes frames;
  std::set<std::array<int, 3>> tiles;  ///< with points, in `tile_blocks` of the fusion
  size_t computed = 0;                 ///< the others were in the store
  double seconds = 0.0;                ///< of the dive, from the first keyframe to the last
  bool complete = true;                ///< false where `progress` ended the work
};

/// Computes the depths of all keyframes that the store lacks. With two cameras it matches their images; with
/// one, it compares each keyframe with its neighbours. `cameras`: one or two. Reads the source's images to
/// their end. Reports stretches without walls as `walls_blind`.
DiveDepths computeDepths(MeasurementSource& source, const std::vector<CameraCalibration>& cameras,
                         const Trajectory& trajectory_ENU, const DiveDepthOptions& options,
                         double tile_edge_m, const DepthStore& store, const WallProgress& progress,
                         Diagnostics* diagnostics);

}  // namespace lodeline
