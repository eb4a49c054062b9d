#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Whether this build reads films. Without FFmpeg's libraries all functions of this folder throw InputError.
bool canReadFilms();

/// One track of a film file.
struct FilmTrack {
  enum class Kind { Images, Telemetry, Other };
  int index = 0;
  Kind kind = Kind::Other;
  std::string codec;  ///< e.g. "h264"
  std::string tag;    ///< four characters of the container, e.g. "avc1", "gpmd"
  int width_px = 0;   ///< 0 for tracks without images
  int height_px = 0;
  double rate_hz = 0.0;      ///< mean rate of the images as the container states it; 0 where it does not
  int64_t stated_count = 0;  ///< packets that the container's index lists; 0 without an index
  Duration start;            ///< of the first packet, with the edit list
  Duration length;           ///< zero where the container does not state it
  double turned_deg = 0.0;   ///< rotation that players apply, clockwise; images are delivered without it
};

/// What the headers of a film file state.
struct FilmInfo {
  std::vector<FilmTrack> tracks;
  std::map<std::string, std::string> tags;  ///< e.g. "creation_time", "firmware"

  /// The first track of that kind; null where there is none.
  const FilmTrack* first(FilmTrack::Kind kind) const;
};

/// Reads the headers of an MP4, MOV, MKV or any other file that libavformat reads. Throws InputError where it
/// cannot be opened, and names the usual reason: a recording that was cut off has no index.
FilmInfo describeFilm(const std::filesystem::path& file);

/// One packet of a track.
struct FilmPacket {
  Duration time;      ///< presentation time since the start of the file, with the edit list
  Duration length;    ///< zero where it is not stated
  bool shown = true;  ///< false for packets that only serve to decode others (before the edit's start)
  std::vector<uint8_t> bytes;
};

/// Reads the packets of one track in stored order. Other tracks are not read. Memory holds one packet.
class FilmTrackReader {
 public:
  /// Throws InputError as describeFilm() does. `track`: its index.
  FilmTrackReader(const std::filesystem::path& file, int track);
  ~FilmTrackReader();
  FilmTrackReader(FilmTrackReader&&) noexcept;
  FilmTrackReader& operator=(FilmTrackReader&&) noexcept;

  /// The next packet; nothing at the end of the track or where the file is cut off.
  std::optional<FilmPacket> next();
  int64_t packets() const { return packets_; }  ///< read so far

 private:
  friend class FilmFrameTimes;
  struct Demuxer;
  /// As next(), without a copy of the bytes. `decode_time`: no later packet has an earlier time.
  bool advance(FilmPacket* packet, std::optional<Duration>* decode_time, bool with_bytes);
  std::unique_ptr<Demuxer> demuxer_;
  int64_t packets_ = 0;
};

/// Gives the times of a track's images in the order of their presentation, without decoding them. Memory
/// holds the times of the few images that the codec reorders.
class FilmFrameTimes {
 public:
  FilmFrameTimes(const std::filesystem::path& file, int track);
  std::optional<Duration> next();
  int64_t packets() const { return reader_.packets(); }  ///< read so far

 private:
  FilmTrackReader reader_;
  std::vector<Duration> waiting_;  ///< heap, the earliest first
  std::optional<Duration> settled_;
  bool ended_ = false;
};

}  // namespace lodeline
