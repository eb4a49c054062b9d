#include "lodeline/io/rosbag/image_messages.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "lodeline/io/images/image_loader.h"
#include "lodeline/io/rosbag/film_topic.h"
#include "lodeline/io/rosbag/messages.h"

namespace lodeline::messages {
namespace {

constexpr int kAsItIs = -1;
constexpr uint32_t kGreatestSide_px = 1 << 15;

/// Pixel layout of an encoding, and OpenCV's conversion to the pixels returned. OpenCV names a Bayer mosaic
/// by the second and third pixel of its second row, ROS by its first two pixels. The luminance of nv12 and
/// its like comes first, as a whole image; the colours after it are not used.
struct Encoding {
  std::string_view name;
  int type;
  int conversion = kAsItIs;
};

constexpr std::array kEncodings = {
    Encoding{"mono8", CV_8UC1},
    Encoding{"8UC1", CV_8UC1},
    Encoding{"mono16", CV_16UC1},
    Encoding{"16UC1", CV_16UC1},
    Encoding{"bgr8", CV_8UC3},
    Encoding{"8UC3", CV_8UC3},
    Encoding{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    Encoding{"bgra8", CV_8UC4},
    Encoding{"8UC4", CV_8UC4},
    Encoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2BGRA},
    Encoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
    Encoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
    Encoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
    Encoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY},
    Encoding{"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2GRAY},
    Encoding{"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2GRAY},
    Encoding{"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2GRAY},
    Encoding{"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2GRAY},
    Encoding{"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    Encoding{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    Encoding{"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    Encoding{"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    Encoding{"nv12", CV_8UC1},
    Encoding{"nv21", CV_8UC1},
    Encoding{"nv24", CV_8UC1},
};

/// The fields of an Image; `data` points into the message.
struct Parsed {
  uint32_t height = 0;
  uint32_t width = 0;
  std::string_view encoding;
  bool is_big_endian = false;
  uint32_t step = 0;
  std::span<const uint8_t> data;
};

Parsed parse(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  reader.take<uint32_t>();
  reader.takeTime();
  reader.takeText();
  Parsed image;
  image.height = reader.take<uint32_t>();
  image.width = reader.take<uint32_t>();
  image.encoding = reader.takeText();
  image.is_big_endian = reader.take<uint8_t>() != 0;
  image.step = reader.take<uint32_t>();
  image.data = reader.takeSized();
  return image;
}

void swapBytes(cv::Mat* pixels) {
  for (int row = 0; row < pixels->rows; ++row) {
    std::transform(pixels->ptr<uint16_t>(row), pixels->ptr<uint16_t>(row) + pixels->cols,
                   pixels->ptr<uint16_t>(row),
                   [](uint16_t value) { return static_cast<uint16_t>(value << 8 | value >> 8); });
  }
}

cv::Mat convert(const Parsed& image, const Encoding& encoding) {
  // OpenCV's interface lacks const; the pixels are only read.
  const cv::Mat lent(static_cast<int>(image.height), static_cast<int>(image.width), encoding.type,
                     const_cast<uint8_t*>(image.data.data()), image.step);
  cv::Mat pixels = lent;
  if (lent.depth() == CV_16U && image.is_big_endian) {
    pixels = lent.clone();
    swapBytes(&pixels);
  }
  if (encoding.conversion == kAsItIs) return pixels.clone();
  cv::Mat converted;
  cv::cvtColor(pixels, converted, encoding.conversion);
  return converted;
}

std::string whyUnusable(const Parsed& image, const Encoding* encoding) {
  if (encoding == nullptr) {
    return fmt::format("encoding '{}' is not supported; record mono8, mono16, rgb8, bgr8 or bayer_…",
                       image.encoding);
  }
  if (image.width == 0 || image.height == 0 || image.width > kGreatestSide_px ||
      image.height > kGreatestSide_px) {
    return fmt::format("its size {} x {} makes no sense", image.width, image.height);
  }
  const size_t row = image.width * static_cast<size_t>(CV_ELEM_SIZE(encoding->type));
  const bool fits = image.step >= row && image.step % CV_ELEM_SIZE1(encoding->type) == 0 &&
                    image.data.size() >= size_t{image.step} * (image.height - 1) + row;
  if (fits) return {};
  return fmt::format("{} bytes are too few for {} x {} px of {} with rows of {} bytes", image.data.size(),
                     image.width, image.height, image.encoding, image.step);
}

StoredImage storedImage(ImageForm form, std::span<const uint8_t> message, const std::string& name) {
  return form == ImageForm::Compressed ? compressedImageFile(message, name) : imagePixels(message, name);
}

LoadedImage greyImage(ImageForm form, std::span<const uint8_t> message, const std::string& name,
                      const GreyRange& range) {
  const StoredImage stored = storedImage(form, message, name);
  if (!stored.problem.empty()) return {cv::Mat(), stored.problem};
  return form == ImageForm::Compressed ? decodeGreyImage(stored.file, name, range)
                                       : LoadedImage{greyFrom(stored.pixels, range), ""};
}

}  // namespace

cv::Mat storedPixels(ImageForm form, std::span<const uint8_t> message) {
  const StoredImage stored = storedImage(form, message, "");
  return form == ImageForm::Compressed ? decodeStoredPixels(stored.file) : stored.pixels;
}

PendingImage pendingImage(ImageForm form, wire::Bytes bytes, const std::string& where,
                          const GreyRange& range) {
  const auto message = std::make_shared<const wire::Bytes>(std::move(bytes));
  const Time stamp = stampOf(*message);
  const std::string name = fmt::format("{} at {} ns", where, stamp.nanoseconds());
  return {stamp, name, [=] { return greyImage(form, *message, name, range); },
          [=] { return storedImage(form, *message, name); }};
}

StoredImage imagePixels(std::span<const uint8_t> message, const std::string& name) {
  StoredImage result;
  try {
    const Parsed image = parse(message);
    const auto* encoding = std::find_if(kEncodings.begin(), kEncodings.end(),
                                        [&](const Encoding& known) { return known.name == image.encoding; });
    if (encoding == kEncodings.end()) encoding = nullptr;
    result.problem = whyUnusable(image, encoding);
    if (result.problem.empty()) result.pixels = convert(image, *encoding);
  } catch (const wire::Reader::CutOff& error) {
    result.problem = error.what();
  } catch (const cv::Exception& error) {
    result.problem = error.what();
  }
  if (!result.problem.empty()) result.problem = fmt::format("{}: {}", name, result.problem);
  return result;
}

StoredImage compressedImageFile(std::span<const uint8_t> message, const std::string& name) {
  StoredImage result;
  try {
    wire::Reader reader(message);
    reader.take<uint32_t>();
    reader.takeTime();
    reader.takeText();
    // The bytes of a file identify its format more reliably than this text; those of a film do not.
    const std::string_view format = reader.takeText();
    const std::span<const uint8_t> file = reader.takeSized();
    result.file.assign(file.begin(), file.end());
    if (file.empty()) result.problem = name + ": holds no image";
    if (!filmCodec(format).empty()) {
      result.problem = fmt::format("{}: encoding '{}' depends on the images before", name, format);
    }
  } catch (const wire::Reader::CutOff& error) {
    result.problem = fmt::format("{}: {}", name, error.what());
  }
  return result;
}

wire::Bytes image(Time stamp, const std::string& frame, const cv::Mat& pixels, uint32_t sequence) {
  wire::Writer writer;
  writer.put(sequence);
  writer.putTime(stamp);
  writer.putText(frame);
  writer.put(static_cast<uint32_t>(pixels.rows));
  writer.put(static_cast<uint32_t>(pixels.cols));
  const char* grey = pixels.depth() == CV_16U ? "mono16" : "mono8";
  writer.putText(pixels.channels() == 1 ? grey : pixels.channels() == 3 ? "bgr8" : "bgra8");
  writer.put(uint8_t{0});  // little endian
  const cv::Mat rows = pixels.isContinuous() ? pixels : pixels.clone();
  writer.put(static_cast<uint32_t>(rows.step[0]));
  writer.putSized({rows.data, rows.total() * rows.elemSize()});
  return writer.take();
}

wire::Bytes compressedImage(Time stamp, const std::string& frame, std::span<const uint8_t> file,
                            uint32_t sequence) {
  wire::Writer writer;
  writer.put(sequence);
  writer.putTime(stamp);
  writer.putText(frame);
  writer.putText(isPng(file) ? "png" : "jpeg");
  writer.putSized(file);
  return writer.take();
}

}  // namespace lodeline::messages
