#include "lodeline/io/rosbag/film_topic.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr std::array kCodecs = {std::pair{"h264", "h264"},    std::pair{"h.264", "h264"},
                                std::pair{"avc1", "h264"},    std::pair{"h265", "hevc"},
                                std::pair{"h.265", "hevc"},   std::pair{"hevc", "hevc"},
                                std::pair{"av1", "libdav1d"}, std::pair{"vp9", "vp9"}};

}  // namespace

std::string filmCodec(std::string_view format) {
  std::string lower(format);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const auto& [name, codec] : kCodecs) {
    if (lower.find(name) != std::string::npos) return codec;
  }
  return {};
}

std::optional<PendingImage> FilmTopic::next(std::span<const uint8_t> message, const std::string& where) {
  wire::Reader reader(message);
  reader.take<uint32_t>();
  const Time stamp = reader.takeTime();
  reader.takeText();
  const std::string codec = filmCodec(reader.takeText());
  if (codec.empty()) return std::nullopt;
  const std::string name = fmt::format("{} at {} ns", where, stamp.nanoseconds());
  LoadedImage image = decode(codec, reader.takeSized());
  if (!image.problem.empty()) image.problem = fmt::format("{}: {}", name, image.problem);
  return PendingImage{stamp, name, [image] { return image; },
                      [image] {
                        return StoredImage{{}, image.image, image.problem};
                      }};
}

LoadedImage FilmTopic::decode(const std::string& codec, std::span<const uint8_t> data) {
  try {
    if (!decoder_ || codec != codec_) decoder_ = std::make_unique<MessageDecoder>(codec);
    codec_ = codec;
    return decoder_->decode(data);
  } catch (const InputError& error) {
    return {cv::Mat(), error.what()};
  }
}

wire::Bytes compressedImageOfVideo(std::span<const uint8_t> compressed_video) {
  wire::Reader reader(compressed_video);
  const Time stamp = reader.takeTime();
  const std::string frame(reader.takeText());
  const std::span<const uint8_t> data = reader.takeSized();
  const std::string format(reader.takeText());
  wire::Writer writer;
  writer.put(uint32_t{0});  // sequence
  writer.putTime(stamp);
  writer.putText(frame);
  writer.putText(format);
  writer.putSized(data);
  return writer.take();
}

}  // namespace lodeline
