#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>

#include "lodeline/io/images/grey_range.h"
#include "lodeline/io/rosbag1/wire.h"
#include "lodeline/io/synchronizer/measurement_source.h"

/// sensor_msgs/Image and sensor_msgs/CompressedImage.
namespace lodeline::messages {

/// The pixels of an Image in a copy of their own: mono8 and mono16 as they are, colour (rgb8, bgr8, rgba8,
/// bgra8) as BGR or BGRA, Bayer mosaics and YUV 4:2:2 as grey. Says in `problem` why there are none; never
/// throws for damaged messages. `name`: for messages.
StoredImage imagePixels(std::span<const uint8_t> message, const std::string& name);

/// The bytes of the image file in a CompressedImage.
StoredImage compressedImageFile(std::span<const uint8_t> message, const std::string& name);

enum class ImageForm { Raw, Compressed };

/// The pixels of either as they are stored; empty where they cannot be read.
cv::Mat storedPixels(ImageForm form, std::span<const uint8_t> message);

/// An Image or CompressedImage that is decoded on demand, 16 bits by `range`. `where` it came from: for
/// messages. Throws wire::Reader::CutOff where the message ends before its stamp does.
PendingImage pendingImage(ImageForm form, wire::Bytes message, const std::string& where,
                          const GreyRange& range = {});

/// An Image from 8 or 16-bit grey, BGR or BGRA pixels.
wire::Bytes image(Time stamp, const std::string& frame, const cv::Mat& pixels, uint32_t sequence);
/// `file`: bytes of a JPEG, PNG or other image file.
wire::Bytes compressedImage(Time stamp, const std::string& frame, std::span<const uint8_t> file,
                            uint32_t sequence);

}  // namespace lodeline::messages
