#include "lodeline/io/film/grey_frame.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "lodeline/io/film/av_handles.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace lodeline::av {
namespace {

/// The luminance where it lies among the frame's bytes in a form that OpenCV reads: planar or packed YUV and
/// grey. Empty for other formats (RGB, palettes).
cv::Mat luminance(const AVFrame& frame) {
  const AVPixFmtDescriptor* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  constexpr uint64_t kOther = AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                              AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_FLOAT;
  if (format == nullptr || (format->flags & kOther) != 0 || frame.linesize[0] <= 0) return {};
  const AVComponentDescriptor& grey = format->comp[0];
  if (grey.plane != 0) return {};
  const int bytes = grey.depth > 8 ? 2 : 1;
  if (grey.step % bytes != 0 || grey.offset % bytes != 0) return {};
  const cv::Mat pixels(frame.height, frame.width, CV_MAKETYPE(bytes == 2 ? CV_16U : CV_8U, grey.step / bytes),
                       frame.data[0], static_cast<size_t>(frame.linesize[0]));
  cv::Mat plane = pixels;
  if (pixels.channels() > 1) cv::extractChannel(pixels, plane, grey.offset / bytes);
  if (bytes == 1) return plane;
  cv::Mat shifted;
  plane.convertTo(shifted, CV_8U, 1.0 / (1 << (grey.depth - 8 + grey.shift)));
  return shifted;
}

/// Any pixel format by libswscale; slower.
cv::Mat converted(const AVFrame& frame) {
  SwsContext* scaler =
      sws_getContext(frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width,
                     frame.height, AV_PIX_FMT_GRAY8, SWS_BILINEAR, nullptr, nullptr, nullptr);
  if (scaler == nullptr) return {};
  cv::Mat grey(frame.height, frame.width, CV_8U);
  uint8_t* const target[] = {grey.data, nullptr, nullptr, nullptr};
  const int step[] = {static_cast<int>(grey.step[0]), 0, 0, 0};
  const int rows = sws_scale(scaler, frame.data, frame.linesize, 0, frame.height, target, step);
  sws_freeContext(scaler);
  return rows == frame.height ? grey : cv::Mat();
}

}  // namespace

cv::Mat greyFrame(const AVFrame& frame, cv::Size size) {
  if (frame.width <= 0 || frame.height <= 0 || frame.data[0] == nullptr) return {};
  cv::Mat grey = luminance(frame);
  if (grey.empty()) grey = converted(frame);
  if (grey.empty()) return grey;
  if (size.empty() || size == grey.size()) return grey.data == frame.data[0] ? grey.clone() : grey;
  cv::Mat scaled;
  cv::resize(grey, scaled, size, 0.0, 0.0, cv::INTER_AREA);
  return scaled;
}

}  // namespace lodeline::av
