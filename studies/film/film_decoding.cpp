#include <fmt/core.h>

#include <sys/resource.h>
#include <CLI/CLI.hpp>
#include <chrono>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/film_decoder.h"
#include "lodeline/io/film/film_reader.h"

// Measures how fast the images of a film are decoded to grey, as a run requests them: every Nth image, scaled
// to the width of the rig. Prints one line of figures; see scripts/film_benchmark.sh.

namespace lodeline {
namespace {

double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Decoded {
  int in_film = 0, loaded = 0, unreadable = 0;
};

Decoded decode(const std::string& film, const FilmTrack& track, cv::Size size, int step) {
  FilmFrameTimes times(film, track.index);
  FilmDecoder decoder(film, track.index, size);
  Decoded decoded;
  while (const std::optional<Duration> time = times.next()) {
    if (decoded.in_film++ % step != 0) continue;
    decoder.announce(*time);
    ++decoded.loaded;
    decoded.unreadable += decoder.load(*time).image.empty() ? 1 : 0;
  }
  return decoded;
}

int measure(const std::string& film, int width_px, int step) {
  const FilmInfo info = describeFilm(film);
  const FilmTrack* const track = info.first(FilmTrack::Kind::Images);
  if (track == nullptr) throw InputError(film + ": has no images");
  cv::Size size;
  if (width_px > 0) size = {width_px, track->height_px * width_px / track->width_px};
  const auto start = std::chrono::steady_clock::now();
  const double processor_before_s = processor_s();
  const Decoded decoded = decode(film, *track, size, step);
  const double used_s = processor_s() - processor_before_s;
  const double taken_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const double film_s = decoded.in_film / std::max(track->rate_hz, 1.0);
  fmt::print("{:>6} {:>8} {:>14.1f} {:>16.2f} {:>12.1f}\n", decoded.in_film, decoded.loaded,
             decoded.in_film / taken_s, 1e3 * used_s / decoded.in_film, film_s / taken_s);
  return decoded.unreadable == 0 ? 0 : 1;
}

}  // namespace
}  // namespace lodeline

int main(int argc, char** argv) {
  CLI::App program("Measures how fast the images of a film are decoded");
  std::string film;
  int width_px = 0, step = 1;
  program.add_option("FILM", film)->required();
  program.add_option("--width", width_px, "of the decoded images, px; 0: that of the film")
      ->check(CLI::NonNegativeNumber);
  program.add_option("--step", step, "decode every Nth image")->check(CLI::PositiveNumber);
  CLI11_PARSE(program, argc, argv);
  return lodeline::measure(film, width_px, step);
}
