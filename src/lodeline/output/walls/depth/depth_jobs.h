#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>

#include "lodeline/output/walls/depth/keyframe_views.h"
#include "lodeline/output/walls/depth/stereo_depth.h"
#include "lodeline/output/walls/depth/sweep_depth.h"

namespace lodeline {

/// A keyframe whose depths are still to be computed, by any thread.
struct DepthJob {
  size_t number = 0;
  Time time;
  Rigid3 map_from_view;
  std::function<DepthImage()> compute;  ///< empty images where the recording's are damaged
};

/// Makes one job for each keyframe, in order: by both images of a pair, or by the neighbours of one image.
class DepthJobs {
 public:
  /// Keeps references to `views` and `view`. `is_pair`: whether there are two cameras.
  DepthJobs(KeyframeViews& views, const RectifiedView& view, bool is_pair, const DepthImageOptions& options);

  std::optional<DepthJob> next();

 private:
  /// A keyframe of one camera, decoded when it is first needed.
  struct Frame {
    KeyframeView keyframe;
    Rigid3 map_from_view;
    std::once_flag once;
    cv::Mat grey, colour;  ///< empty where the image is damaged
  };
  std::optional<DepthJob> nextPair();
  std::optional<DepthJob> nextSweep();
  void decode(Frame* frame) const;
  DepthImage pairDepth(const KeyframeView& keyframe) const;
  DepthImage sweepDepth(const std::vector<std::shared_ptr<Frame>>& frames, size_t middle) const;

  KeyframeViews& views_;
  const RectifiedView& view_;
  bool is_pair_;
  StereoDepth stereo_;
  SweepDepth sweep_;
  std::deque<std::shared_ptr<Frame>> window_;
  size_t middle_ = 0;  ///< of the window: the next job
};

}  // namespace lodeline
