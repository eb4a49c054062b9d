#include <stdexcept>

#include "lodeline/io/film/test_film.h"

namespace lodeline::test {

// Tests of films skip in a build without FFmpeg's libraries.
void writeFilm(const std::filesystem::path&, const TestFilm&) { throw std::logic_error("no FFmpeg"); }

}  // namespace lodeline::test
