#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>

#include "lodeline/recording.h"

namespace lodeline {

/// Decodes the images of a film's track to 8-bit grey: the luminance as the codec stores it, scaled down to
/// `size` where that is given. Images are requested by their times (FilmFrameTimes). Requests in rising order
/// decode each image once, or leave out those before a key image; others seek. A second request for the last
/// image costs nothing. Memory holds the codec's images, the last image, and a few that were decoded on the
/// way to a later one. All functions may be called from several threads.
class FilmDecoder {
 public:
  /// Throws InputError where the file cannot be opened or the codec is unknown. `size`: empty for that of the
  /// film.
  FilmDecoder(const std::filesystem::path& file, int track, cv::Size size);
  ~FilmDecoder();

  /// Announces a later load(): an image that is decoded earlier on the way to another one is then kept.
  void announce(Duration time);
  /// The image at exactly that time.
  LoadedImage load(Duration time);
  /// Images that the codec has delivered so far, with those on the way to others.
  int64_t decoded() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Decodes a stream of H.264, H.265 or similar messages, each holding one image. An image depends on those
/// before it, so messages are given in order.
class MessageDecoder {
 public:
  /// `codec`: its name in libavcodec, e.g. "h264", "hevc". Throws InputError where it is unknown.
  explicit MessageDecoder(const std::string& codec);
  ~MessageDecoder();

  /// The grey image of the message. Its `problem` tells why there is none; images before the first key frame
  /// have none.
  LoadedImage decode(std::span<const uint8_t> message);
  /// Forgets the images before, for a jump to a message with a key frame.
  void restart();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodeline
