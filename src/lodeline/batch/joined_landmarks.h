#pragma once

#include <map>
#include <vector>

#include "lodeline/batch/loops/loop_links.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"

namespace lodeline {

/// Tracks of the batch problem that are one landmark by loop observations: their numbers, oldest first.
struct JoinedLandmark {
  std::vector<TrackId> parts;
};

/// Landmarks that loop observations join.
struct JoinedLandmarks {
  std::vector<JoinedLandmark> landmarks;
  int links_used = 0;

  /// Whether a track is a landmark of several parts.
  bool contains(TrackId root) const { return by_root.count(root) > 0; }
  std::map<TrackId, size_t> by_root;  ///< index into `landmarks` by the number of the first part
};

/// Joins the window's tracks by links in their order, with the present poses. Two parts become one landmark
/// where the landmark of all their observations agrees with at least half of the observations of each.
/// Otherwise both stay unchanged: a wrong link costs no observation. Two parts that are seen in one image
/// are two points. A joined landmark has the number of its oldest part; the other parts' tracks are removed.
///
/// `loosening` > 1: at first the loop is open by more than the errors of images. The observations of all
/// parts but the oldest then count with sigmas larger by this factor. Their tracks stay as well: the motion
/// between neighbouring states keeps its accuracy. Steps with a smaller factor each lead to the common
/// solution, as in a graduated non-convexity (A. Blake, A. Zisserman, "Visual reconstruction", 1987).
JoinedLandmarks joinLandmarks(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                              const std::vector<LoopLink>& links, double loosening);

}  // namespace lodeline
