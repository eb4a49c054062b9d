#pragma once

#include <filesystem>
#include <vector>

#include "simulation/dive/dive.h"
#include "simulation/recording/image_recording.h"
#include "simulation/sensors/sonar_model.h"

namespace lodeline {

/// Writes folder/truth, the data that is unknown in the field:
///   calibration/    sensor.yaml of every true sensor (behind a flat port: the best fit in water)
///   errors.yaml     every error of the sensors, of the calibration files and of the water
///   image_times.csv true middle of each exposure with its stamp
///   cave.yaml       place of the dive's world in the cave, with a cave seed
///   tags.csv        tags on the line, in the frame of the cave
///   currents.csv, dvl.csv, steel.csv, steel_field.csv  of a vehicle, see vehicle_recording.h
///   landmarks.ply   surface points around the path, W (where `range` is given)
void recordTruth(const Dive& dive, const RenderSettings& settings, const std::vector<ScheduledImage>& images,
                 const RangeFunction& range, const std::filesystem::path& folder);

}  // namespace lodeline
