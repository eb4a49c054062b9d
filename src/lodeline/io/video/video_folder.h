#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace lodeline {

/// The files of a recording of a phone: a film, the stamps of its images, and tables of readings.
struct VideoFolder {
  std::string program;  ///< that wrote it
  std::filesystem::path film;
  std::filesystem::path stamps = {};
  std::filesystem::path gyroscope = {};
  std::filesystem::path accelerometer = {};  ///< the same as `gyroscope` where one table has both
  std::filesystem::path magnetometer = {};   ///< empty where there is none
};

/// Recognizes a recording of a phone, from its film or its folder:
///
///     Mobile AR Sensor Logger   movie.mp4, frame_timestamps.txt, gyro_accel.csv
///     OpenCamera Sensors        NAME.mp4 (VID_DATE.mp4) with NAME_gyro.csv, NAME_accel.csv,
///     NAME_timestamps.csv
///                               and NAME_magnetic.csv beside it or in the folder DATE
///     Sensor Logger and others  one film with Gyroscope.csv, TotalAcceleration.csv, Magnetometer.csv and
///                               frame_timestamps.txt or .csv
///
/// Returns nothing where the files do not belong to one of these.
std::optional<VideoFolder> findVideoFolder(const std::filesystem::path& data);

}  // namespace lodeline
