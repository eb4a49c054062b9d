#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>

#include "lodeline/io/images/grey_range.h"
#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/recording.h"

/// Functions for sensor_msgs/Image and sensor_msgs/CompressedImage.
namespace lodeline::messages {

/// A copy of the pixels of an Image: mono8 and mono16 unchanged, colour (rgb8, bgr8, rgba8, bgra8) as BGR or
/// BGRA, Bayer mosaics and YUV 4:2:2 as grey. Never throws for damaged messages; `problem` then gives the
/// reason. `name`: for messages.
StoredImage imagePixels(std::span<const uint8_t> message, const std::string& name);

/// The bytes of the image file in a CompressedImage.
StoredImage compressedImageFile(std::span<const uint8_t> message, const std::string& name);

enum class ImageForm { Raw, Compressed };

/// The stored pixels of either message type; empty where they cannot be read.
cv::Mat storedPixels(ImageForm form, std::span<const uint8_t> message);

/// An Image or CompressedImage that is decoded on demand, 16 bits by `range`. `where`: origin, for messages.
/// Throws wire::Reader::CutOff where the message ends before or within its stamp.
PendingImage pendingImage(ImageForm form, wire::Bytes message, const std::string& where,
                          const GreyRange& range = {});

/// An Image message from 8 or 16-bit grey, BGR or BGRA pixels.
wire::Bytes image(Time stamp, const std::string& frame, const cv::Mat& pixels, uint32_t sequence);
/// A CompressedImage message. `file`: bytes of a JPEG, PNG or other image file.
wire::Bytes compressedImage(Time stamp, const std::string& frame, std::span<const uint8_t> file,
                            uint32_t sequence);

}  // namespace lodeline::messages
