#pragma once

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "lodeline/util/files/test_data.h"

/// Functions that write and read bags with ROS's own rosbag (Debian's python3-rosbag, hence Debian's Python).
namespace lodeline::test {

inline constexpr const char* kRosbagMissing =
    "python3-rosbag, python3-sensor-msgs or python3-geometry-msgs is not installed";

inline bool hasRosbag() {
  static const bool has =
      std::system("/usr/bin/python3 -c 'import rosbag, sensor_msgs.msg, geometry_msgs.msg' 2>/dev/null") == 0;
  return has;
}

/// Runs test_bag.py with arguments in shell syntax and returns its output.
inline std::string runRosbag(const std::string& arguments) {
  const std::string command = "/usr/bin/python3 '" + testSourceDir().string() +
                              "/src/lodeline/io/rosbag/test_bag.py' " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  std::string output;
  char buffer[4096];
  while (std::fgets(buffer, sizeof(buffer), pipe) != nullptr) output += buffer;
  if (pclose(pipe) != 0) throw std::runtime_error(command + "\n" + output);
  return output;
}

/// Writes a PGM beside every PNG of a recording; Python can read PGM without further packages.
inline void addPgmImages(const std::filesystem::path& mav0) {
  for (const char* camera : {"cam0", "cam1"}) {
    std::vector<std::filesystem::path> images;
    for (const auto& entry : std::filesystem::directory_iterator(mav0 / camera / "data")) {
      if (entry.path().extension() == ".png") images.push_back(entry.path());
    }
    for (std::filesystem::path image : images) {
      const cv::Mat pixels = cv::imread(image.string(), cv::IMREAD_GRAYSCALE);
      cv::imwrite(image.replace_extension(".pgm").string(), pixels);
    }
  }
}

inline std::string contentOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void writeContent(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

}  // namespace lodeline::test
