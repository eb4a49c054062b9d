#pragma once

#include <filesystem>
#include <string>

namespace lodeline {

/// Kind of a file or folder, determined from its first bytes, its name and, for folders, its entries.
enum class FileKind {
  Missing,
  Empty,
  EurocFolder,    ///< contains mav0, or camN, imu0, mag0
  RunFolder,      ///< results of `lodeline run`
  Ros2Folder,     ///< metadata.yaml beside .db3 or .mcap files
  ImageFolder,    ///< images without a list of stamps
  ArchiveFolder,  ///< contains only archives
  Folder,         ///< any other folder
  Ros1Bag,
  Ros2Bag,  ///< SQLite database
  Mcap,
  Archive,     ///< zip, tar, 7z, rar
  Compressed,  ///< one file compressed with gzip, bzip2, xz or zstd
  Video,
  SensorLog,  ///< binary log of an autopilot
  Image,
  Document,  ///< PDF, HDF5, NumPy: recognized, but not usable by Lodeline
  Binary,    ///< bytes of an unknown kind
  Yaml,
  Json,
  Table,  ///< text whose first row has several columns: CSV, TUM, KITTI, …
  Text,
};

/// A recognized file: its kind, a description that fits after "is ", and advice where the file cannot be used
/// directly.
struct RecognizedFile {
  std::filesystem::path path;
  FileKind kind = FileKind::Missing;
  std::string what;
  std::string advice;  ///< empty where there is no advice

  bool isFolder() const { return kind >= FileKind::EurocFolder && kind <= FileKind::Folder; }
  bool isText() const { return kind == FileKind::Empty || kind >= FileKind::Yaml; }
};

/// Determines the kind of `path`. Never throws: a file that cannot be read is Missing, and `what` gives the
/// reason.
RecognizedFile recognizeFile(const std::filesystem::path& path);

/// "PATH: is WHAT; ADVICE", or "PATH: is WHAT; NEEDED" where there is no advice.
std::string refusalText(const RecognizedFile& file, const std::string& needed);
/// Throws InputError with the text of refusalText().
[[noreturn]] void refuseFile(const RecognizedFile& file, const std::string& needed);

}  // namespace lodeline
