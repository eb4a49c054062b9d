#include "lodeline/report/read_landmarks.h"

#include <fstream>
#include <string>

#include "lodeline/base/error.h"

namespace lodeline {

std::vector<Eigen::Vector3f> readLandmarks(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be read");
  std::string layout;
  std::string line;
  while (std::getline(stream, line) && line != "end_header") {
    if (line.rfind("property", 0) == 0 || line.rfind("format", 0) == 0) layout += line + "\n";
  }
  if (line != "end_header" || layout !=
                                  "format binary_little_endian 1.0\nproperty float x\nproperty float y\n"
                                  "property float z\nproperty int sightings\n") {
    throw InputError(file.string() + ": not the layout that `lodeline run` writes");
  }
  std::vector<Eigen::Vector3f> points;
  Eigen::Vector3f point;
  int32_t sightings = 0;
  while (stream.read(reinterpret_cast<char*>(point.data()), 3 * sizeof(float)) &&
         stream.read(reinterpret_cast<char*>(&sightings), sizeof(sightings))) {
    points.push_back(point);
  }
  return points;
}

}  // namespace lodeline
