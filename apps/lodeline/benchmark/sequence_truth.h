#pragma once

#include <filesystem>

#include "lodeline/diagnostics.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Poses of a bag's topic of PoseStamped or Odometry. Throws InputError, naming the bag's topics of poses,
/// where it has no such topic or no pose in it.
Trajectory readBagPoses(const std::filesystem::path& bag, const std::string& topic, Diagnostics* diagnostics);

/// Whether a bag has a topic.
bool hasTopic(const std::filesystem::path& bag, const std::string& topic);

/// Poses with numbers of images in place of times: `number x y z qx qy qz qw`. An image has its number at the
/// end of its file name. Throws InputError with the line for anything else, and for a number without image.
Trajectory readNumberedPoses(const std::filesystem::path& file, const std::filesystem::path& image_list,
                             Diagnostics* diagnostics);

/// Poses of the body from those of the first camera, by the rig of the recording.
Trajectory bodyFromCamera(Trajectory poses, const std::filesystem::path& data, const BagArguments& arguments,
                          Diagnostics* diagnostics);

}  // namespace lodeline
