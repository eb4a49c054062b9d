#include "lodeline/evaluation/trajectory/read_body_from_camera.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/text_table.h"

namespace lodeline {

Rigid3 readBodyFromCamera(const std::filesystem::path& path) {
  const std::string name = path.string();
  try {
    const YAML::Node entry = YAML::Load(readFileBytes(path))["T_BS"];
    const YAML::Node data = entry && entry.IsMap() ? entry["data"] : entry;
    if (!data || !data.IsSequence() || data.size() != 16) {
      throw InputError(fmt::format("{}: no entry T_BS with 16 numbers (body from camera, row by row)", name));
    }
    Eigen::Matrix4d body_from_camera;
    for (int i = 0; i < 16; ++i) body_from_camera(i / 4, i % 4) = data[i].as<double>();
    return Rigid3::fromMatrix(body_from_camera, (name + ": T_BS").c_str());
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}: {}", name, error.what()));
  }
}

}  // namespace lodeline
