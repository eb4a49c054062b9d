#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Small films for tests, written with libavformat.
namespace lodeline::test {

/// One payload of a telemetry track.
struct FilmPayload {
  double time_s = 0.0;
  double length_s = 1.0;
  std::vector<uint8_t> bytes;
};

/// A film of flat images whose grey tells their number (greyOfImage), with a telemetry track where there are
/// payloads. The container follows the name of the file.
struct TestFilm {
  int images = 30;
  int width_px = 64;
  int height_px = 48;
  int images_per_s = 30;
  std::string codec = "mpeg4";
  int reordered = 0;            ///< B images between others
  int key_step = 12;            ///< images from one key image to the next
  double images_start_s = 0.0;  ///< positive: an empty edit comes first; negative: an edit cuts images off
  bool index_first = false;     ///< the index before the images
  double turned_deg = 0.0;
  std::vector<FilmPayload> telemetry = {};
};

/// Grey of image `number`: distinct for 40 images in a row.
inline int greyOfImage(int number) { return 40 + 4 * (number % 40); }

void writeFilm(const std::filesystem::path& file, const TestFilm& film);

/// A folder that its destructor removes.
class FilmFolder {
 public:
  FilmFolder();
  ~FilmFolder();
  FilmFolder(const FilmFolder&) = delete;
  FilmFolder& operator=(const FilmFolder&) = delete;

  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  const std::filesystem::path& path() const { return folder_; }
  void write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace lodeline::test
