#pragma once

#include <vector>

#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/types.h"

namespace lodeline {

/// A point of one track that a later (or earlier) image shows again.
struct LoopObservation {
  TrackId old_track = -1;  ///< of the front end; its landmark is observed again
  Time old_time;           ///< at which that track was matched
  Time new_time;           ///< of the image that shows the point again
  /// In that image. With a track, all observations of the two tracks are of one landmark. With track -1 (a
  /// corner that was not tracked), the observation is added to the old track.
  FeatureObservation observation;
};

/// Pose of a frame from which the batch solution starts.
struct InitialPose {
  Time time;  ///< of a frame of the record
  Rigid3 world_from_body;
};

/// Accepted loops, for the batch solution.
struct LoopClosures {
  std::vector<LoopObservation> observations;
  /// In order of time. They must close the loops, as those of a pose graph do: a loop that is open by metres
  /// contradicts its observations. Only their heading and position are used. The correction is interpolated
  /// between them and constant outside. Empty: the poses of the forward run.
  std::vector<InitialPose> initial_poses;
};

}  // namespace lodeline
