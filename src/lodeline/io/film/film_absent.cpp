#include "lodeline/diagnostics.h"
#include "lodeline/io/film/film_decoder.h"
#include "lodeline/io/film/film_reader.h"

// The functions of this folder in a build without FFmpeg's libraries.
namespace lodeline {
namespace {

[[noreturn]] void refuse(const std::string& name) {
  throw InputError(name +
                   ": this build reads no films; install libavformat-dev, libavcodec-dev and libswscale-dev, "
                   "and build Lodeline again");
}

}  // namespace

bool canReadFilms() { return false; }
const FilmTrack* FilmInfo::first(FilmTrack::Kind) const { return nullptr; }
FilmInfo describeFilm(const std::filesystem::path& file) { refuse(file.string()); }

struct FilmTrackReader::Demuxer {};
FilmTrackReader::FilmTrackReader(const std::filesystem::path& file, int) { refuse(file.string()); }
FilmTrackReader::~FilmTrackReader() = default;
FilmTrackReader::FilmTrackReader(FilmTrackReader&&) noexcept = default;
FilmTrackReader& FilmTrackReader::operator=(FilmTrackReader&&) noexcept = default;
bool FilmTrackReader::advance(FilmPacket*, std::optional<Duration>*, bool) { return false; }
std::optional<FilmPacket> FilmTrackReader::next() { return std::nullopt; }

FilmFrameTimes::FilmFrameTimes(const std::filesystem::path& file, int track) : reader_(file, track) {}
std::optional<Duration> FilmFrameTimes::next() { return std::nullopt; }

struct FilmDecoder::State {};
FilmDecoder::FilmDecoder(const std::filesystem::path& file, int, cv::Size) { refuse(file.string()); }
FilmDecoder::~FilmDecoder() = default;
void FilmDecoder::announce(Duration) {}
LoadedImage FilmDecoder::load(Duration) { return {}; }
int64_t FilmDecoder::decoded() const { return 0; }

struct MessageDecoder::State {};
MessageDecoder::MessageDecoder(const std::string& codec) { refuse(codec); }
MessageDecoder::~MessageDecoder() = default;
LoadedImage MessageDecoder::decode(std::span<const uint8_t>) { return {}; }
void MessageDecoder::restart() {}

}  // namespace lodeline
