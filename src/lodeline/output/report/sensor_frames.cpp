#include "lodeline/output/report/sensor_frames.h"

#include <fmt/core.h>

namespace lodeline {

void SensorFrames::add(const std::vector<SensorRow>& rows) {
  for (const SensorRow& row : rows) ++frames_[row.sensor][row.status];
}

void SensorFrames::describe(SummaryLines* lines) const {
  for (const auto& [sensor, by_status] : frames_) {
    int all = 0;
    for (const auto& [status, frames] : by_status) all += frames;
    std::string text;
    for (const auto& [status, frames] : by_status)
      text += fmt::format("{}{} {:.1f} %", text.empty() ? "" : ", ", status, 100.0 * frames / all);
    lines->add(sensor, text);
  }
}

void SensorFrames::addTo(nlohmann::ordered_json* json) const {
  for (const auto& [sensor, by_status] : frames_) {
    for (const auto& [status, frames] : by_status) (*json)[sensor]["frames"][status] = frames;
  }
}

}  // namespace lodeline
