#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>

namespace lodeline {

/// Decodes 8-bit grey PNG images without interlacing, the kind that recordings use. Returns an empty image
/// for every other kind and for damaged data, which a general decoder may then decode or explain.
///
/// This decoder exists because decoding takes a notable share of the time per frame. On EuRoC's 752x480
/// images it takes 2.5 ms against 3.6 ms for OpenCV, both including reading the file; libspng, which uses
/// zlib too, takes 4.3 ms. libdeflate inflates twice as fast as zlib. The Paeth filter of two rows is undone
/// at once, with an offset of one pixel. Format: W3C, "Portable Network Graphics (PNG) Specification",
/// sections 5, 9 and 11.
cv::Mat decodeGreyPng(std::span<const uint8_t> bytes);

}  // namespace lodeline
