#include "lodeline/cameras/camera_file_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

namespace lodeline {

CameraFileKeys cameraFileKeys(const CameraCalibration& c) {
  const CameraModel& model = cameraModel(c);
  const auto split = c.distortion.begin() + static_cast<std::ptrdiff_t>(model.before_focal_lengths);
  CameraFileKeys keys;
  keys.camera_model = model.projections.front();
  keys.intrinsics.assign(c.distortion.begin(), split);
  keys.intrinsics.insert(keys.intrinsics.end(), {c.fx_px, c.fy_px, c.cx_px, c.cy_px});
  keys.distortion_coefficients.assign(split, c.distortion.end());
  keys.distortion_model = keys.distortion_coefficients.empty() ? "none" : model.distortions.front();
  return keys;
}

void setFromFileKeys(const CameraModel& model, const CameraFileKeys& keys, CameraCalibration* c) {
  const auto focal_lengths =
      keys.intrinsics.begin() + static_cast<std::ptrdiff_t>(model.before_focal_lengths);
  c->model = model.name;
  c->fx_px = focal_lengths[0];
  c->fy_px = focal_lengths[1];
  c->cx_px = focal_lengths[2];
  c->cy_px = focal_lengths[3];
  c->distortion.assign(keys.intrinsics.begin(), focal_lengths);
  c->distortion.insert(c->distortion.end(), keys.distortion_coefficients.begin(),
                       keys.distortion_coefficients.end());
}

std::string intrinsicsNames(const CameraModel& model) {
  std::string names;
  for (size_t i = 0; i < model.before_focal_lengths; ++i) names += fmt::format("{}, ", model.parameters[i]);
  return names + "fx, fy, cx, cy";
}

std::string cameraFileModels() {
  std::map<std::string_view, std::vector<std::string_view>> distortions;
  for (const CameraModel& model : cameraModels())
    distortions[model.projections.front()].push_back(model.distortions.front());
  std::vector<std::string> words;
  for (const auto& [projection, names] : distortions)
    words.push_back(fmt::format("{} ({})", projection, fmt::join(names, ", ")));
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace lodeline
