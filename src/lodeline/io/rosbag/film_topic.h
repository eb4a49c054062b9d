#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lodeline/io/film/film_decoder.h"
#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/recording.h"

namespace lodeline {

/// The name in libavcodec of the codec that `format` of a CompressedImage or CompressedVideo names, as "h264"
/// for "H.264"; empty for the formats of image files.
std::string filmCodec(std::string_view format);

/// The images of a topic that holds a film: CompressedImage messages with the format H.264, H.265, VP9 or
/// AV1, each with one image. An image depends on those before it; so each is decoded when its message is
/// read.
class FilmTopic {
 public:
  /// The decoded image of the topic's next message; nothing where the message holds an image file. `where`:
  /// origin, for messages. Throws wire::Reader::CutOff for a message that is cut off.
  std::optional<PendingImage> next(std::span<const uint8_t> message, const std::string& where);

 private:
  LoadedImage decode(const std::string& codec, std::span<const uint8_t> data);

  std::unique_ptr<MessageDecoder> decoder_;
  std::string codec_;
};

/// The CompressedImage message with the content of a foxglove_msgs/CompressedVideo. Throws
/// wire::Reader::CutOff for a message that is cut off.
wire::Bytes compressedImageOfVideo(std::span<const uint8_t> compressed_video);

}  // namespace lodeline
