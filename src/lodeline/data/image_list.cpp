#include "lodeline/data/image_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

#include "lodeline/base/csv_fields.h"
#include "lodeline/base/error.h"
#include "lodeline/base/time_unit.h"

namespace lodeline {
namespace {

constexpr std::array kTimesFiles = {"timestamps.txt", "times.txt", "timestamps.csv", "times.csv"};

bool isImageFile(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  constexpr std::array kKinds = {".png", ".jpg", ".jpeg", ".pgm", ".bmp", ".tif", ".tiff"};
  return std::find(kKinds.begin(), kKinds.end(), extension) != kKinds.end();
}

std::vector<std::filesystem::path> imageFiles(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (isImageFile(entry.path())) files.push_back(entry.path());
  }
  return files;
}

/// Nanoseconds of a name or row: integers as they are, decimals in seconds.
std::optional<Time> stampOf(std::string_view text) {
  const bool is_decimal = text.find('.') != std::string_view::npos;
  const std::optional<int64_t> ns =
      parseTime_ns(text, is_decimal ? TimeUnit::Seconds : TimeUnit::Nanoseconds);
  return ns ? std::optional(Time::fromNanoseconds(*ns)) : std::nullopt;
}

/// "frame9" before "frame10": by the number at the end, then by name.
bool comesBefore(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::string first = a.stem().string(), second = b.stem().string();
  const auto digits = [](const std::string& name) {
    size_t begin = name.size();
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1])) != 0) --begin;
    const size_t significant = std::min(name.find_first_not_of('0', begin), name.size());
    return name.substr(significant);
  };
  const std::string i = digits(first), j = digits(second);
  return i.size() != j.size() ? i.size() < j.size() : i != j ? i < j : first < second;
}

/// Whether the names count images instead of telling times.
bool areCounts(const std::vector<ListedImage>& images) {
  return images.size() > 1 && images.back().time - images.front().time <
                                  Duration::fromNanoseconds(1000 * static_cast<int64_t>(images.size()));
}

std::optional<std::vector<ListedImage>> byNames(const std::vector<std::filesystem::path>& files) {
  std::vector<ListedImage> images;
  for (const std::filesystem::path& file : files) {
    const std::optional<Time> time = stampOf(file.stem().string());
    if (!time) return std::nullopt;
    images.push_back({*time, file});
  }
  std::sort(images.begin(), images.end(),
            [](const ListedImage& a, const ListedImage& b) { return a.time < b.time; });
  if (areCounts(images)) return std::nullopt;
  return images;
}

std::vector<Time> readTimes(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<Time> times;
  for (std::string line; std::getline(stream, line);) {
    const std::string_view row = csv::trimmed(line);
    const std::optional<Time> time = stampOf(row.substr(0, row.find_first_of(" \t,;")));
    if (time) times.push_back(*time);
  }
  return times;
}

}  // namespace

ImageList::ImageList(const std::filesystem::path& camera, Diagnostics* diagnostics)
    : folder_(camera / "data"), origin_(camera / "data.csv") {
  if (std::filesystem::exists(origin_)) {
    csv_.emplace(origin_, 0, diagnostics);
  } else {
    makeList(camera);
  }
}

bool ImageList::hasImages(const std::filesystem::path& camera) {
  return std::filesystem::exists(camera / "data.csv") || !imageFiles(camera / "data").empty();
}

void ImageList::makeList(const std::filesystem::path& camera) {
  std::vector<std::filesystem::path> files = imageFiles(folder_);
  if (auto images = byNames(files)) {
    origin_ = folder_;
    made_ = std::move(*images);
    return;
  }
  std::string seen;
  for (const std::filesystem::path& place :
       {camera, folder_, camera.parent_path(), camera.parent_path().parent_path()}) {
    for (const char* name : kTimesFiles) {
      const std::filesystem::path file = place / name;
      if (!std::filesystem::is_regular_file(file)) continue;
      const std::vector<Time> times = readTimes(file);
      if (times.size() != files.size()) {
        seen += fmt::format("; {} has {} times", file.string(), times.size());
        continue;
      }
      std::sort(files.begin(), files.end(), comesBefore);
      for (size_t i = 0; i < files.size(); ++i) made_.push_back({times[i], files[i]});
      origin_ = file;
      return;
    }
  }
  throw InputError(
      fmt::format("{}: missing, and no list can be made for the {} images in {}: their names are no stamps{}; "
                  "write one row an image, '#timestamp [ns],filename', or name the images by their stamps",
                  (camera / "data.csv").string(), files.size(), folder_.string(), seen));
}

std::optional<ListedImage> ImageList::next() {
  if (!csv_) {
    if (next_ == made_.size()) return std::nullopt;
    return made_[next_++];
  }
  if (!csv_->next(&row_)) return std::nullopt;
  const std::string name = row_.text.empty() ? fmt::format("{}.png", row_.time.nanoseconds()) : row_.text;
  return ListedImage{row_.time, folder_ / name};
}

}  // namespace lodeline
