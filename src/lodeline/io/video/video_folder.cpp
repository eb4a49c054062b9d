#include "lodeline/io/video/video_folder.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <vector>

namespace lodeline {
namespace {

namespace fs = std::filesystem;

bool isFilm(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kFilms = {".mp4", ".mov", ".mkv", ".avi"};
  return std::find(kFilms.begin(), kFilms.end(), extension) != kFilms.end();
}

std::vector<fs::path> filmsIn(const fs::path& folder) {
  std::vector<fs::path> films;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (isFilm(entry.path())) films.push_back(entry.path());
  }
  std::sort(films.begin(), films.end());
  return films;
}

/// The first of the names that is a file in the folder; empty where none is.
fs::path firstOf(const fs::path& folder, std::initializer_list<std::string> names) {
  std::error_code ignored;
  for (const std::string& name : names) {
    if (fs::is_regular_file(folder / name, ignored)) return folder / name;
  }
  return {};
}

bool isComplete(const VideoFolder& found) {
  return !found.stamps.empty() && !found.gyroscope.empty() && !found.accelerometer.empty();
}

std::optional<VideoFolder> marsLogger(const fs::path& film) {
  const fs::path folder = film.parent_path();
  VideoFolder found{"Mobile AR Sensor Logger", film};
  found.stamps = firstOf(folder, {"frame_timestamps.txt", "frame_timestamps.csv", "movie_metadata.csv"});
  found.gyroscope = found.accelerometer = firstOf(folder, {"gyro_accel.csv"});
  return isComplete(found) ? std::optional(found) : std::nullopt;
}

std::optional<VideoFolder> openCameraSensors(const fs::path& film) {
  const std::string name = film.stem().string();
  const std::string date = name.starts_with("VID_") ? name.substr(4) : name;
  for (const fs::path& folder : {film.parent_path() / date, film.parent_path()}) {
    VideoFolder found{"OpenCamera Sensors", film};
    found.stamps = firstOf(folder, {name + "_timestamps.csv", name + "timestamps.csv"});
    found.gyroscope = firstOf(folder, {name + "_gyro.csv", name + "gyro.csv"});
    found.accelerometer = firstOf(folder, {name + "_accel.csv", name + "accel.csv"});
    found.magnetometer = firstOf(folder, {name + "_magnetic.csv", name + "magnetic.csv"});
    if (isComplete(found)) return found;
  }
  return std::nullopt;
}

std::optional<VideoFolder> sensorLogger(const fs::path& film) {
  for (const fs::path& folder : {film.parent_path(), film.parent_path().parent_path()}) {
    VideoFolder found{"Sensor Logger", film};
    found.stamps = firstOf(folder, {"frame_timestamps.txt", "frame_timestamps.csv", "timestamps.txt",
                                    "timestamps.csv", "Camera.csv"});
    found.gyroscope = firstOf(folder, {"GyroscopeUncalibrated.csv", "Gyroscope.csv"});
    found.accelerometer = firstOf(folder, {"AccelerometerUncalibrated.csv", "TotalAcceleration.csv"});
    found.magnetometer = firstOf(folder, {"MagnetometerUncalibrated.csv", "Magnetometer.csv"});
    if (isComplete(found)) return found;
  }
  return std::nullopt;
}

}  // namespace

std::optional<VideoFolder> findVideoFolder(const fs::path& data) {
  std::error_code ignored;
  std::vector<fs::path> films = {data};
  if (fs::is_directory(data, ignored)) {
    films = filmsIn(data);
    const std::vector<fs::path> in_camera = filmsIn(data / "Camera");
    films.insert(films.end(), in_camera.begin(), in_camera.end());
  }
  if (films.size() != 1) return std::nullopt;
  if (auto found = marsLogger(films.front())) return found;
  if (auto found = openCameraSensors(films.front())) return found;
  return sensorLogger(films.front());
}

}  // namespace lodeline
