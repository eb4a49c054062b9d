#include "lodeline/io/video/film_chapter.h"

#include <fmt/core.h>

namespace lodeline {

std::vector<FilmChapter> joinChapters(const std::vector<std::filesystem::path>& files) {
  std::vector<FilmChapter> chapters;
  for (const std::filesystem::path& file : files) {
    FilmChapter chapter;
    chapter.file = file;
    chapter.info = describeFilm(file);
    const FilmTrack* images = chapter.info.first(FilmTrack::Kind::Images);
    if (images == nullptr || images->width_px <= 0 || images->height_px <= 0) {
      throw InputError(file.string() + ": holds no images");
    }
    chapter.images = *images;
    const FilmTrack* telemetry = chapter.info.first(FilmTrack::Kind::Telemetry);
    if (telemetry != nullptr) chapter.telemetry = *telemetry;
    if (!chapters.empty()) {
      const FilmChapter& before = chapters.back();
      if (before.images.width_px != images->width_px || before.images.height_px != images->height_px) {
        throw InputError(fmt::format("{}: {} x {} px, but the chapter before has {} x {}", file.string(),
                                     images->width_px, images->height_px, before.images.width_px,
                                     before.images.height_px));
      }
      chapter.start = before.start + before.images.start + before.images.length - images->start;
    }
    chapters.push_back(std::move(chapter));
  }
  return chapters;
}

}  // namespace lodeline
