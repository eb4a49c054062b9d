#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/film_reader.h"

namespace lodeline {

/// One file of a film, and its place on the clock of the whole: zero where the images of the first file start
/// (its container's zero).
struct FilmChapter {
  std::filesystem::path file;
  FilmTrack images;
  std::optional<FilmTrack> telemetry;  ///< a GPMF track
  FilmInfo info;
  Duration start;  ///< of this file's clock
};

/// Opens the chapters and joins them without a pause, by the lengths of their image tracks. Throws InputError
/// where one has no images, or images of another size than the first.
std::vector<FilmChapter> joinChapters(const std::vector<std::filesystem::path>& files);

}  // namespace lodeline
