#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace lodeline {

/// Positions (m, world) of a `landmarks.ply` that LandmarkWriter wrote. Of a run that was killed, whose
/// header still says zero, all whole points that are there. Throws InputError, naming the file, where it
/// cannot be read or has another layout.
std::vector<Eigen::Vector3f> readLandmarks(const std::filesystem::path& file);

}  // namespace lodeline
