#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace lodeline {

/// A text file opened for writing; the folder is created. Throws InputError naming the path on failure.
class RecordingFile {
 public:
  explicit RecordingFile(const std::filesystem::path& path);
  void write(const std::string& text);
  /// Throws where a write failed, e.g. on a full disk.
  void close();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

/// Header lines of the data.csv files in the EuRoC ASL layout.
inline constexpr const char* kImuColumns =
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
inline constexpr const char* kImageColumns = "#timestamp [ns],filename\n";
inline constexpr const char* kMagnetometerColumns = "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n";
inline constexpr const char* kDepthColumns = "#timestamp [ns],depth [m]\n";
inline constexpr const char* kSonarColumns = "#timestamp [ns],range [m],angle [rad]\n";
inline constexpr const char* kAltimeterColumns = "#timestamp [ns],range [m]\n";

}  // namespace lodeline
