#include "lodeline/io/logs/open_sensor_log.h"

#include <array>
#include <fstream>
#include <string_view>

#include "lodeline/io/logs/binary/autopilot_log.h"
#include "lodeline/io/logs/binary/dataflash.h"
#include "lodeline/io/logs/binary/ulog.h"
#include "lodeline/io/logs/files/folder_log.h"
#include "lodeline/io/logs/files/table_log.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

constexpr const char* kWanted =
    "give a folder with mav0, a ROS bag, a log of an autopilot, or a table of readings "
    "(docs/reference/file-formats.md)";

enum class Kind { None, Table, Tables, ULog, DataFlash };

/// The kind of a file by its first bytes after decompression.
Kind kindOfFile(const std::filesystem::path& path, const RecognizedFile& recognized) {
  constexpr std::string_view kULog = "ULog\x01\x12\x35", kDataFlash = "\xA3\x95";
  std::array<char, 8> head = {};
  size_t size = 0;
  const std::unique_ptr<ByteSource> bytes = openFile(path);
  for (size_t got = 1; size < head.size() && got > 0; size += got)
    got = bytes->read(head.data() + size, head.size() - size);
  const std::string_view text(head.data(), size);
  for (const std::string_view bag : {"#ROS", "SQLi", "\x89MCA", "PK\3\4", "BZh"}) {
    if (text.starts_with(bag)) refuseFile(recognized, kWanted);
  }
  if (text.starts_with(kULog)) return Kind::ULog;
  return text.starts_with(kDataFlash) ? Kind::DataFlash : Kind::Table;
}

bool isZip(const std::filesystem::path& path) {
  std::array<char, 4> head = {};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size());
  return std::string_view(head.data(), head.size()) == "PK\3\4";
}

bool holdsTables(const std::filesystem::path& path) { return !chooseTables(tablesIn(path)).isEmpty(); }

Kind kindOf(const std::filesystem::path& path) {
  const RecognizedFile recognized = recognizeFile(path);
  switch (recognized.kind) {
    case FileKind::Table:
    case FileKind::Text:
      return Kind::Table;
    case FileKind::SensorLog:
    case FileKind::Compressed:
      return kindOfFile(path, recognized);
    case FileKind::Archive:
      if (!isZip(path) || !holdsTables(path)) refuseFile(recognized, kWanted);
      return Kind::Tables;
    case FileKind::Folder:
      return holdsTables(path) ? Kind::Tables : Kind::None;
    case FileKind::Missing:
    case FileKind::Ros1Bag:
    case FileKind::Ros2Bag:
    case FileKind::Mcap:
      return Kind::None;
    default:
      if (!recognized.isFolder()) refuseFile(recognized, kWanted);
      return Kind::None;
  }
}

}  // namespace

bool isSensorLog(const std::filesystem::path& path) { return kindOf(path) != Kind::None; }

std::unique_ptr<SensorLog> openSensorLog(const std::filesystem::path& path, const PlainCsvOptions& options,
                                         Diagnostics* diagnostics) {
  const std::string name = path.string();
  switch (kindOf(path)) {
    case Kind::ULog:
      return std::make_unique<AutopilotLog>([=] { return std::make_unique<ULog>(openFile(path), name); },
                                            name, "a log of PX4 (ULog)", diagnostics);
    case Kind::DataFlash:
      return std::make_unique<AutopilotLog>([=] { return std::make_unique<DataFlash>(openFile(path), name); },
                                            name, "a log of ArduPilot (DataFlash)", diagnostics);
    case Kind::Tables:
      return std::make_unique<FolderLog>(path, diagnostics);
    default:
      return std::make_unique<TableLog>(path, options, diagnostics);
  }
}

}  // namespace lodeline
