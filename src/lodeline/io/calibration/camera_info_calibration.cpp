#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_translation.h"

namespace lodeline {
namespace {

/// The first existing key of several spellings.
std::string requireOneOf(std::initializer_list<const char*> keys, CalibrationMap* map) {
  for (const char* key : keys) {
    if (map->has(key)) return key;
  }
  throw InputError(map->at(*keys.begin()) + " is missing; the camera cannot be used without it");
}

}  // namespace

YAML::Node translateCameraInfo(CalibrationMap* root) {
  YAML::Node camera;
  for (const std::string& key :
       {requireOneOf({"image_width", "width"}, root), requireOneOf({"image_height", "height"}, root)}) {
    camera["resolution"].push_back(root->text(key));
  }
  const YAML::Node matrix = numbersAsWritten(requireOneOf({"camera_matrix", "K", "k"}, root), 9, root);
  for (const size_t i : {0u, 4u, 2u, 5u}) camera["intrinsics"].push_back(matrix[i].Scalar());
  const std::string key = requireOneOf({"distortion_coefficients", "D", "d"}, root);
  const std::vector<double> coefficients = root->numbers(key);
  const bool is_ideal =
      std::all_of(coefficients.begin(), coefficients.end(), [](double number) { return number == 0.0; });
  std::string model = root->has("distortion_model") ? root->text("distortion_model") : "plumb_bob";
  if (const CameraModel* known = findCameraModel(model)) model = known->distortions.front();
  if (is_ideal) model = "none";
  camera["distortion_model"] = model;
  if (!is_ideal) camera["distortion_coefficients"] = numbersAsWritten(key, coefficients.size(), root);
  return camera;
}

}  // namespace lodeline
