#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lodeline/io/images/grey_range.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Reads any image file as 8-bit grey: converts colour to luminance and scales 16 bits to 8 by `range`. Never
/// throws for a missing or damaged file; the result states the problem.
LoadedImage loadGreyImage(const std::filesystem::path& file, const GreyRange& range = {});

/// Decodes the bytes of an image file in the same way. `name`: for messages.
LoadedImage decodeGreyImage(std::span<const uint8_t> bytes, const std::string& name,
                            const GreyRange& range = {});

/// Pixels as stored in a file; empty where it cannot be read.
cv::Mat decodeStoredPixels(std::span<const uint8_t> bytes);

/// The bytes of an image file.
StoredImage loadStoredImage(const std::filesystem::path& file);

/// Whether the bytes are a PNG file, whose pixels are stored without loss.
bool isPng(std::span<const uint8_t> bytes);

/// 8-bit luminance from 8 or 16-bit pixels with one, three (BGR) or four (BGRA) channels; `range` scales 16
/// bits.
cv::Mat greyFrom(const cv::Mat& pixels, const GreyRange& range = {});

}  // namespace lodeline
