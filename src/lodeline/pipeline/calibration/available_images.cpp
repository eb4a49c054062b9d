#include "lodeline/pipeline/calibration/available_images.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/image_times.h"
#include "lodeline/evaluation/trajectory/text_table.h"

namespace lodeline {
namespace {

/// Stamp of the last listed image that exists, and whether it is the last in the list.
struct LastImage {
  Time stamp;
  bool ends_list = false;
};

LastImage lastImage(const std::filesystem::path& camera) {
  const TextTable table = readTextTable(camera / "data.csv");
  for (auto line = table.lines.rbegin(); line != table.lines.rend(); ++line) {
    const std::string name = line->fields.size() > 1 ? line->fields[1] : line->fields[0] + ".png";
    if (!std::filesystem::exists(camera / "data" / name)) continue;
    return {table.timeInNanoseconds(*line, 0), line == table.lines.rbegin()};
  }
  throw InputError(fmt::format("{}: none of the images listed in data.csv is there", camera.string()));
}

}  // namespace

double AvailableImages::available_s() const {
  return stamps.empty() ? 0.0 : (stamps.back() - stamps.front()).seconds();
}

AvailableImages findAvailableImages(const std::filesystem::path& data, const EurocOptions& options) {
  const EurocLayout layout = findEurocLayout(data, options);
  AvailableImages images;
  std::optional<Time> end;
  for (const int index : layout.camera_indices) {
    const LastImage last = lastImage(layout.sensor(fmt::format("cam{}", index)));
    if (last.ends_list) continue;
    images.complete = false;
    end = end ? std::min(*end, last.stamp) : last.stamp;
  }
  images.stamps = readImageStamps(layout.sensor(fmt::format("cam{}", layout.camera_indices.front())));
  images.whole_s = (images.stamps.back() - images.stamps.front()).seconds();
  if (end) std::erase_if(images.stamps, [&](Time stamp) { return stamp > *end; });
  return images;
}

}  // namespace lodeline
