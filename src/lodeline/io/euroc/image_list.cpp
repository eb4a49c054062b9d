#include "lodeline/io/euroc/image_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/util/csv_fields.h"
#include "lodeline/util/time/time_unit.h"

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

/// Parses texts as times in one common unit: the one that gives a plausible camera rate, otherwise
/// nanoseconds, and seconds for decimals. Returns nothing where one of them is not a number.
std::optional<std::vector<Time>> timesOf(const std::vector<std::string>& texts) {
  std::vector<double> numbers;
  bool has_decimals = false;
  for (const std::string& text : texts) {
    double number = 0.0;
    if (!csv::parse(std::string_view(text), &number)) return std::nullopt;
    numbers.push_back(number);
    has_decimals = has_decimals || text.find('.') != std::string::npos;
  }
  const TimeUnit usual = has_decimals ? TimeUnit::Seconds : TimeUnit::Nanoseconds;
  const TimeUnit unit = timeUnitOfStamps(numbers, kCameraRate).value_or(usual);
  std::vector<Time> times;
  for (const std::string& text : texts) {
    const std::optional<int64_t> ns = parseTime_ns(text, unit);
    if (!ns) return std::nullopt;
    times.push_back(Time::fromNanoseconds(*ns));
  }
  return times;
}

/// Orders by the number at the end, then by name: "frame9" before "frame10".
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

/// Whether the names are image counts instead of times.
bool areCounts(const std::vector<std::string>& names) {
  int64_t least = std::numeric_limits<int64_t>::max(), greatest = 0;
  for (const std::string& name : names) {
    int64_t number = 0;
    if (!csv::parse(std::string_view(name), &number) || number < 0) return false;
    least = std::min(least, number);
    greatest = std::max(greatest, number);
  }
  return greatest - least < 2 * static_cast<int64_t>(names.size());
}

std::optional<std::vector<ListedImage>> byNames(const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> names;
  for (const std::filesystem::path& file : files) names.push_back(file.stem().string());
  const std::optional<std::vector<Time>> times = areCounts(names) ? std::nullopt : timesOf(names);
  if (!times) return std::nullopt;
  std::vector<ListedImage> images;
  for (size_t i = 0; i < files.size(); ++i) images.push_back({(*times)[i], files[i]});
  std::sort(images.begin(), images.end(),
            [](const ListedImage& a, const ListedImage& b) { return a.time < b.time; });
  return images;
}

std::vector<Time> readTimes(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> rows;
  for (std::string line; std::getline(stream, line);) {
    const std::string_view row = csv::trimmed(line);
    const std::string_view first = row.substr(0, row.find_first_of(" \t,;"));
    double number = 0.0;
    if (csv::parse(first, &number)) rows.emplace_back(first);
  }
  return timesOf(rows).value_or(std::vector<Time>());
}

}  // namespace

ImageList::ImageList(const std::filesystem::path& camera, Diagnostics* diagnostics)
    : folder_(camera / "data"), origin_(camera / "data.csv") {
  if (std::filesystem::exists(origin_)) {
    csv_.emplace(origin_, CsvContent::Images, diagnostics, kCameraRate);
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
  throw InputError(fmt::format(
      "{}: missing, and no list can be made for the {} images in {}: their names are no stamps{}; "
      "write one row an image, '#timestamp [ns],filename', or name the images by their stamps",
      (camera / "data.csv").string(), files.size(), folder_.string(), seen));
}

std::optional<ListedImage> ImageList::next() {
  if (!csv_) {
    if (next_ == made_.size()) return std::nullopt;
    return made_[next_++];
  }
  if (!csv_->next(&row_)) return std::nullopt;
  const std::string name = row_.text.empty() ? fmt::format("{}.png", csv_->stampText()) : row_.text;
  return ListedImage{row_.time, folder_ / name};
}

std::optional<double> ImageList::shareRead() const {
  if (csv_) return csv_->shareRead();
  return made_.empty() ? 1.0 : static_cast<double>(next_) / static_cast<double>(made_.size());
}

}  // namespace lodeline
