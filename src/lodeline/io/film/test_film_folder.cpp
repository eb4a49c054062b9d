#include <unistd.h>

#include <atomic>
#include <fstream>

#include "lodeline/io/film/test_film.h"

namespace lodeline::test {

FilmFolder::FilmFolder() {
  static std::atomic<int> count{0};
  folder_ = std::filesystem::temp_directory_path() /
            ("lodeline_film_" + std::to_string(getpid()) + "_" + std::to_string(count++));
  std::filesystem::create_directories(folder_);
}

FilmFolder::~FilmFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void FilmFolder::write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories(path(name).parent_path());
  std::ofstream(path(name), std::ios::binary) << text;
}

}  // namespace lodeline::test
