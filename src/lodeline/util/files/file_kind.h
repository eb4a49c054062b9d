#pragma once

#include <filesystem>
#include <string>

namespace lodeline {

/// What a file or folder is, by its first bytes, its name and, for folders, what they hold.
enum class FileKind {
  Missing,
  Empty,
  EurocFolder,    ///< holds mav0, or camN, imu0, mag0
  RunFolder,      ///< results of `lodeline run`
  Ros2Folder,     ///< metadata.yaml beside .db3 or .mcap files
  ImageFolder,    ///< pictures without a list
  ArchiveFolder,  ///< holds archives, and nothing that could be a recording
  Folder,         ///< any other
  Ros1Bag,
  Ros2Bag,  ///< SQLite database
  Mcap,
  Archive,     ///< zip, tar, 7z, rar
  Compressed,  ///< one file packed by gzip, bzip2, xz or zstd
  Video,
  Image,
  Document,  ///< PDF, HDF5, NumPy: known, and of no use here
  Binary,    ///< bytes of an unknown kind
  Yaml,
  Json,
  Table,  ///< text whose first row has several columns: CSV, TUM, KITTI, …
  Text,
};

/// A kind, in words that fit behind "is ", and what to do with such a file where it is of no use as it is.
struct RecognizedFile {
  std::filesystem::path path;
  FileKind kind = FileKind::Missing;
  std::string what;
  std::string advice;  ///< empty where there is none

  bool isFolder() const { return kind >= FileKind::EurocFolder && kind <= FileKind::Folder; }
  bool isText() const { return kind == FileKind::Empty || kind >= FileKind::Yaml; }
};

/// Never throws; a file that cannot be read is Missing, and `what` says why.
RecognizedFile recognizeFile(const std::filesystem::path& path);

/// "PATH: is WHAT; ADVICE", or where no advice is known "PATH: is WHAT; NEEDED".
std::string refusalText(const RecognizedFile& file, const std::string& needed);
/// Throws InputError with that text.
[[noreturn]] void refuseFile(const RecognizedFile& file, const std::string& needed);

}  // namespace lodeline
