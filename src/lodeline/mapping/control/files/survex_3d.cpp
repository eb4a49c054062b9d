#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <iterator>

#include "lodeline/mapping/control/files/survex_files.h"

namespace lodeline {
namespace {

constexpr std::string_view kFileId = "Survex 3D Image File\n";
constexpr double kMetresPerUnit = 0.01;
constexpr size_t kLongestLabel = 65536;

// Codes of items, and flags of stations.
constexpr unsigned kStop = 0x00, kLastStyle = 0x04, kMove = 0x0f, kNoDate = 0x10, kDate = 0x11,
                   kDateSpan = 0x12, kTwoDates = 0x13, kErrors = 0x1f, kShortSection = 0x30,
                   kLongSection = 0x32, kLine = 0x40, kLabel = 0x80;
constexpr unsigned kSameLabel = 0x20;
constexpr unsigned kEntrance = 0x04, kFixed = 0x10, kAnonymous = 0x20, kWall = 0x40;

/// Reads the items of a .3d file.
class Survex3dReader {
 public:
  Survex3dReader(std::string name, std::string bytes) : name_(std::move(name)), bytes_(std::move(bytes)) {}

  SurvexSurvey read() {
    readHeader();
    while (readItem()) {
    }
    return std::move(survey_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(fmt::format("{}: byte {}: {}", name_, place_, reason));
  }

  std::string_view take(size_t size) {
    if (size > bytes_.size() - place_) fail("the file ends too early");
    const std::string_view part = std::string_view(bytes_).substr(place_, size);
    place_ += size;
    return part;
  }
  unsigned byte() { return static_cast<unsigned char>(take(1)[0]); }
  uint32_t word() {
    const std::string_view part = take(4);
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i)
      value |= static_cast<uint32_t>(static_cast<unsigned char>(part[i])) << (8 * i);
    return value;
  }
  std::string_view lineOf() {
    const size_t end = bytes_.find('\n', place_);
    if (end == std::string::npos) fail("the header ends too early");
    const std::string_view line = take(end - place_);
    ++place_;
    return line;
  }

  void readHeader() {
    take(kFileId.size());
    const std::string version(lineOf());
    if (version != "v8") {
      fail(fmt::format(
          "the format is '{}'; version 8 is read, which `cavern` of Survex 1.2.7 and later writes", version));
    }
    const std::string_view texts = lineOf();
    const size_t end = texts.find('\0');
    survey_.title = std::string(texts.substr(0, end));
    if (end != std::string_view::npos) {
      const std::string_view rest = texts.substr(end + 1);
      survey_.coordinate_system = std::string(rest.substr(0, rest.find('\0')));
    }
    lineOf();  // time at which the file was made
    if ((byte() & 0x80) != 0) fail("the file is an extended elevation, no plan of the cave");
  }

  /// Reads one item; false after the last one.
  bool readItem() {
    const unsigned code = byte();
    if (code == kStop) {
      if (style_ == 0) return false;
      style_ = 0;
    } else if (code <= kLastStyle) {
      style_ = code;
    } else if (code == kMove) {
      position();
    } else if (code >= kNoDate && code <= kTwoDates) {
      take(code == kNoDate ? 0 : code == kDate ? 2 : code == kDateSpan ? 3 : 4);
    } else if (code == kErrors) {
      take(20);
    } else if (code >= kShortSection && code < kLongSection + 2) {
      readLabel();
      take(code < kLongSection ? 8 : 16);
    } else if (code >= kLabel) {
      readStation(code);
    } else if (code >= kLine) {
      if ((code & kSameLabel) == 0) readLabel();
      position();
    } else {
      fail(fmt::format("unknown item 0x{:02x}", code));
    }
    return true;
  }

  void readStation(unsigned code) {
    readLabel();
    SurvexStation station;
    station.name = label_;
    station.position = position();
    station.is_fixed = (code & kFixed) != 0;
    station.is_entrance = (code & kEntrance) != 0;
    if ((code & (kAnonymous | kWall)) == 0 && !label_.empty()) survey_.stations.push_back(std::move(station));
  }

  Vec3 position() {
    Vec3 position_m;
    for (double& coordinate : position_m) coordinate = kMetresPerUnit * std::bit_cast<int32_t>(word());
    return position_m;
  }

  size_t length() {
    const unsigned size = byte();
    return size == 255 ? word() : size;
  }

  /// Changes the label: so many characters less at its end, then those of the file.
  void readLabel() {
    size_t removed = 0, added = 0;
    if (const unsigned both = byte(); both != 0) {
      removed = both >> 4;
      added = both & 0x0f;
    } else {
      removed = length();
      added = length();
    }
    if (removed > label_.size()) fail("a label is shortened by more than it has");
    label_.resize(label_.size() - removed);
    label_ += take(added);
    if (label_.size() > kLongestLabel) fail("a label is too long");
  }

  std::string name_;
  std::string bytes_;
  size_t place_ = 0;
  unsigned style_ = 0xff;  ///< none yet
  std::string label_;
  SurvexSurvey survey_;
};

std::ifstream openBinary(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file))
    throw InputError(fmt::format("{}: cannot be read", file.string()));
  return stream;
}

}  // namespace

bool isSurvex3d(const std::filesystem::path& file) {
  std::ifstream stream = openBinary(file);
  std::string begin(kFileId.size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == kFileId || file.extension() == ".3d";
}

SurvexSurvey readSurvex3d(const std::filesystem::path& file) {
  std::ifstream stream = openBinary(file);
  std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!bytes.starts_with(kFileId))
    throw InputError(fmt::format("{}: is no .3d file of Survex", file.string()));
  return Survex3dReader(file.string(), std::move(bytes)).read();
}

}  // namespace lodeline
