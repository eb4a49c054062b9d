#include "lodeline/io/video/video_text.h"

#include <fmt/core.h>

#include <algorithm>

namespace lodeline {
namespace {

std::string chapterText(const FilmChapter& chapter) {
  const FilmTrack& images = chapter.images;
  const double start_s = (chapter.start + images.start).seconds();
  std::string text =
      fmt::format("film {}\n  images     {} x {} px, {}, {} in the index, {:.4f} Hz, {:.4f} to {:.4f} s\n",
                  chapter.file.string(), images.width_px, images.height_px, images.codec, images.stated_count,
                  images.rate_hz, start_s, start_s + images.length.seconds());
  if (!chapter.telemetry) return text + "  telemetry  none\n";
  const FilmTrack& telemetry = *chapter.telemetry;
  const double telemetry_s = (chapter.start + telemetry.start).seconds();
  return text + fmt::format("  telemetry  {} payloads in the index, {:.4f} to {:.4f} s\n",
                            telemetry.stated_count, telemetry_s, telemetry_s + telemetry.length.seconds());
}

}  // namespace

std::string videoText(const VideoSource& source) {
  std::string text;
  for (const FilmChapter& chapter : source.chapters()) text += chapterText(chapter);
  if (source.sensors() == nullptr) return text;
  text += fmt::format("  {:<18} {:<6} {:>9} {:>9} {:>10} {:>10} {:>10}  {}\n", "device", "stream", "samples",
                      "counted", "rate Hz", "first s", "last s", "unit, name, axes from");
  for (const VideoStreamFacts& facts : source.sensors()->facts()) {
    const std::string counted = facts.counted ? fmt::format("{}", *facts.counted) : "-";
    text += fmt::format("  {:<18} {:<6} {:>9} {:>9} {:>10.3f} {:>10.4f} {:>10.4f}  {}{}{}{}\n", facts.device,
                        facts.key, facts.samples, counted, facts.rate_hz, facts.first_s, facts.last_s,
                        facts.unit.empty() ? "-" : facts.unit, facts.name.empty() ? "" : ", " + facts.name,
                        facts.axes.empty() ? "" : ", ", facts.axes);
  }
  return text;
}

}  // namespace lodeline
