#include "lodeline/util/files/file_kind.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;
using namespace std::string_view_literals;

constexpr const char* kLogUse =
    "it holds no images; `lodeline attitude`, `allan`, `inspect` and `calibrate magnetometer` read it";
constexpr const char* kUnpack = "unpack it and give the folder or the bag that it holds";

/// Magic bytes at an offset that identify a kind of file.
struct Signature {
  size_t offset;
  std::string_view bytes;
  FileKind kind;
  const char* what;
  const char* advice;
};

constexpr std::array kSignatures = {
    Signature{0, "#ROSBAG V"sv, FileKind::Ros1Bag, "a ROS 1 bag", ""},
    Signature{0, "#ROSRECORD"sv, FileKind::Ros1Bag, "a ROS 1 bag of an old format", ""},
    Signature{0, "SQLite format 3\0"sv, FileKind::Ros2Bag, "a SQLite database, as ROS 2 bags are", ""},
    Signature{0, "\x89MCAP0\r\n"sv, FileKind::Mcap, "a bag of ROS 2 (MCAP)", ""},
    Signature{0, "PK\3\4"sv, FileKind::Archive, "an archive (zip)", kUnpack},
    Signature{0, "PK\5\6"sv, FileKind::Archive, "an empty archive (zip)", ""},
    Signature{0, "7z\xBC\xAF\x27\x1C"sv, FileKind::Archive, "an archive (7z)", kUnpack},
    Signature{0, "Rar!\x1A\7"sv, FileKind::Archive, "an archive (rar)", kUnpack},
    Signature{257, "ustar"sv, FileKind::Archive, "an archive (tar)", kUnpack},
    Signature{0, "\x1F\x8B"sv, FileKind::Compressed, "packed (gzip)", kUnpack},
    Signature{0, "BZh"sv, FileKind::Compressed, "packed (bzip2)", kUnpack},
    Signature{0,
              "\xFD"
              "7zXZ\0"sv,
              FileKind::Compressed, "packed (xz)", kUnpack},
    Signature{0, "\x28\xB5\x2F\xFD"sv, FileKind::Compressed, "packed (zstd)", kUnpack},
    Signature{4, "ftyp"sv, FileKind::Video, "a film (MP4 or MOV)", ""},
    Signature{4, "moov"sv, FileKind::Video, "a film (MOV)", ""},
    Signature{4, "mdat"sv, FileKind::Video, "a film (MOV)", ""},
    Signature{8, "AVI "sv, FileKind::Video, "a film (AVI)", ""},
    Signature{0, "\x1A\x45\xDF\xA3"sv, FileKind::Video, "a film (MKV or WebM)", ""},
    Signature{0, "\0\0\1\xBA"sv, FileKind::Video, "a film (MPEG)", ""},
    Signature{0, "OggS"sv, FileKind::Video, "a film (Ogg)", ""},
    Signature{0, "\x89PNG\r\n"sv, FileKind::Image, "a picture (PNG)", ""},
    Signature{0, "\xFF\xD8\xFF"sv, FileKind::Image, "a picture (JPEG)", ""},
    Signature{0, "II*\0"sv, FileKind::Image, "a picture (TIFF)", ""},
    Signature{0, "MM\0*"sv, FileKind::Image, "a picture (TIFF)", ""},
    Signature{0, "GIF8"sv, FileKind::Image, "a picture (GIF)", ""},
    Signature{8, "WEBP"sv, FileKind::Image, "a picture (WebP)", ""},
    Signature{0, "%PDF"sv, FileKind::Document, "a PDF document", ""},
    Signature{0, "\x89HDF\r\n"sv, FileKind::Document, "an HDF5 file", "write its readings as CSV"},
    Signature{0, "\x93NUMPY"sv, FileKind::Document, "a NumPy array", "write its rows with numpy.savetxt"},
    Signature{0, "MATLAB 5.0"sv, FileKind::Document, "a MATLAB file", "write its readings as CSV"},
    Signature{0, "\xA3\x95"sv, FileKind::SensorLog, "a log of ArduPilot", kLogUse},
    Signature{0, "ULog\1\x12\x35"sv, FileKind::SensorLog, "a log of PX4", kLogUse},
    Signature{0,
              "\x7F"
              "ELF"sv,
              FileKind::Binary, "a program", ""},
};

/// File name extensions for kinds that the first bytes do not identify: the file is empty or truncated, or
/// its magic bytes are elsewhere.
struct Extension {
  std::string_view name;
  FileKind kind;
  const char* what;
  const char* advice;
};

constexpr std::array kExtensions = {
    Extension{".db3", FileKind::Ros2Bag, "a ROS 2 bag, by its name", ""},
    Extension{".mcap", FileKind::Mcap, "a ROS 2 bag, by its name", ""},
    Extension{".bag", FileKind::Ros1Bag, "a ROS 1 bag, by its name", ""},
    Extension{".tar", FileKind::Archive, "an archive, by its name", kUnpack},
    Extension{".zip", FileKind::Archive, "an archive, by its name", kUnpack},
    Extension{".mp4", FileKind::Video, "a film, by its name", ""},
    Extension{".mov", FileKind::Video, "a film, by its name", ""},
    Extension{".avi", FileKind::Video, "a film, by its name", ""},
    Extension{".mkv", FileKind::Video, "a film, by its name", ""},
    Extension{".svo", FileKind::Video, "a recording of a ZED camera, by its name",
              "export it with the ZED SDK: images, stamps and IMU readings"},
};

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Whether the name is that of a file of a ROS 2 bag, which may be packed: .db3, .mcap, .db3.zstd,
/// .mcap.zstd.
bool isNamedAsRos2Bag(fs::path path) {
  if (lowerExtension(path) == ".zstd") path.replace_extension();
  const std::string extension = lowerExtension(path);
  return extension == ".db3" || extension == ".mcap";
}

template <typename Range>
bool isOneOf(const std::string& text, const Range& known) {
  return std::find(known.begin(), known.end(), text) != known.end();
}

/// Number of bytes read for recognition: includes tar's magic bytes and the first rows of a text.
constexpr size_t kHeadBytes = 4096;

std::string headOf(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string head(kHeadBytes, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(stream.gcount()));
  return head;
}

/// UTF-16 counts as text because the table readers accept it.
bool looksLikeText(std::string_view head) {
  if (head.starts_with("\xFF\xFE"sv) || head.starts_with("\xFE\xFF"sv)) return true;
  const auto odd = std::count_if(head.begin(), head.end(), [](unsigned char c) {
    return c < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && c != 0x1A;
  });
  return odd == 0;
}

FileKind kindOfText(const fs::path& path, std::string_view head) {
  const std::string extension = lowerExtension(path);
  const size_t first = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first == std::string_view::npos) return FileKind::Text;
  if (extension == ".json" || head[first] == '{') return FileKind::Json;
  if (extension == ".yaml" || extension == ".yml" || head.starts_with("%YAML")) return FileKind::Yaml;
  size_t row = first;
  while (row < head.size() && head[row] == '#') row = std::min(head.find('\n', row), head.size() - 1) + 1;
  const std::string_view line = head.substr(row, head.find_first_of("\r\n", row) - row);
  const bool has_columns = line.find_first_of(",; \t") != std::string_view::npos;
  return has_columns ? FileKind::Table : FileKind::Text;
}

RecognizedFile recognizeText(const fs::path& path, std::string_view head) {
  const FileKind kind = kindOfText(path, head);
  switch (kind) {
    case FileKind::Yaml:
      return {path, kind, "a YAML file",
              "a calibration goes with --rig or --mag-calibration, settings with -c"};
    case FileKind::Json:
      return {path, kind, "a JSON file", ""};
    case FileKind::Table:
      return {path, kind, "a table", ""};
    default:
      return {path, kind, "a text", ""};
  }
}

RecognizedFile recognizeRegular(const fs::path& path) {
  const std::string head = headOf(path);
  if (lowerExtension(path) == ".zstd" && isNamedAsRos2Bag(path)) {
    return {path, FileKind::Ros2Bag, "a packed file of a ROS 2 bag", ""};
  }
  for (const Signature& known : kSignatures) {
    if (head.size() < known.offset) continue;
    if (std::string_view(head).substr(known.offset).starts_with(known.bytes)) {
      return {path, known.kind, known.what, known.advice};
    }
  }
  const std::string extension = lowerExtension(path);
  for (const Extension& known : kExtensions) {
    if (extension == known.name) return {path, known.kind, known.what, known.advice};
  }
  if (head.empty()) return {path, FileKind::Empty, "empty", "copy it again"};
  if (looksLikeText(head)) return recognizeText(path, head);
  return {path, FileKind::Binary, "of an unknown kind (no text)", ""};
}

/// Counts of the entries of a folder by kind, determined from their names.
struct Entries {
  size_t pictures = 0;
  size_t archives = 0;
  size_t others = 0;
  bool has_mav0 = false, has_sensor = false, has_run = false, has_metadata = false, has_ros2 = false;
  std::string first_archive, first_bag;
};

void take(const fs::directory_entry& entry, Entries* entries) {
  static constexpr std::array kPictures = {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm"};
  static constexpr std::array kArchives = {".zip", ".tar", ".gz", ".tgz", ".7z", ".rar", ".bz2", ".xz"};
  const std::string name = entry.path().filename().string();
  const std::string extension = lowerExtension(entry.path());
  std::error_code ignored;
  if (entry.is_directory(ignored)) {
    entries->has_mav0 = entries->has_mav0 || name == "mav0";
    entries->has_sensor = entries->has_sensor || name == "cam0" || name == "imu0" || name == "mag0";
  }
  entries->has_run = entries->has_run || name == "run.json";
  entries->has_metadata = entries->has_metadata || name == "metadata.yaml";
  entries->has_ros2 = entries->has_ros2 || isNamedAsRos2Bag(entry.path());
  if (extension == ".bag" && entries->first_bag.empty()) entries->first_bag = name;
  if (isOneOf(extension, kPictures)) {
    ++entries->pictures;
  } else if (isOneOf(extension, kArchives)) {
    if (entries->first_archive.empty() || name < entries->first_archive) entries->first_archive = name;
    ++entries->archives;
  } else {
    ++entries->others;
  }
}

RecognizedFile recognizeFolder(const fs::path& path) {
  constexpr size_t kMostEntries = 100'000;
  Entries entries;
  std::error_code error;
  size_t count = 0;
  for (auto entry = fs::directory_iterator(path, error);
       !error && entry != fs::directory_iterator() && count < kMostEntries; entry.increment(error), ++count) {
    take(*entry, &entries);
  }
  if (entries.has_mav0 || entries.has_sensor) return {path, FileKind::EurocFolder, "a recording", ""};
  if (entries.has_ros2) return {path, FileKind::Ros2Folder, "a ROS 2 bag", ""};
  if (entries.has_run) {
    return {path, FileKind::RunFolder, "the results of a run",
            "run, inspect and calibrate take the recording; evaluate, export and report take results"};
  }
  if (!entries.first_bag.empty()) {
    return {path, FileKind::Folder, "a folder with a ROS 1 bag",
            fmt::format("give the bag itself: {}", (path / entries.first_bag).string())};
  }
  if (entries.pictures > 0) {
    return {path, FileKind::ImageFolder,
            fmt::format("a folder of {} pictures without a list", entries.pictures),
            "Lodeline needs the stamp of each image and the readings of an IMU: mav0/cam0/data.csv, "
            "mav0/cam0/data/STAMP.png, mav0/imu0/data.csv (docs/reference/file-formats.md)"};
  }
  if (entries.archives > 0 && entries.others == 0) {
    return {path, FileKind::ArchiveFolder, "a folder of archives",
            fmt::format("unpack {} first", (path / entries.first_archive).string())};
  }
  return {path, FileKind::Folder, count == 0 ? "an empty folder" : "a folder", ""};
}

}  // namespace

RecognizedFile recognizeFile(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    const bool is_absent = status.type() == fs::file_type::not_found;
    return {
        path, FileKind::Missing,
        is_absent ? "missing (no such folder or file)" : fmt::format("not readable ({})", error.message()),
        ""};
  }
  if (fs::is_directory(status)) return recognizeFolder(path);
  // Pipes and devices can be read only once, so this function must not read from them.
  if (!fs::is_regular_file(status)) return {path, FileKind::Text, "no regular file", ""};
  if (!std::ifstream(path)) return {path, FileKind::Missing, "not readable (see its permissions)", ""};
  return recognizeRegular(path);
}

std::string refusalText(const RecognizedFile& file, const std::string& needed) {
  return fmt::format("{}: is {}; {}", file.path.string(), file.what,
                     file.advice.empty() ? needed : file.advice);
}

void refuseFile(const RecognizedFile& file, const std::string& needed) {
  throw InputError(refusalText(file, needed));
}

}  // namespace lodeline
