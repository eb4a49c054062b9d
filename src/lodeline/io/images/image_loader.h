#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "lodeline/io/images/grey_range.h"
#include "lodeline/io/synchronizer/measurement_source.h"

namespace lodeline {

/// Reads an image file as 8-bit grey, whatever it holds: colour is weighted to luminance, 16 bits are scaled
/// to 8 by `range`. Never throws for a missing or damaged file; says so in the result.
LoadedImage loadGreyImage(const std::filesystem::path& file, const GreyRange& range = {});

/// The same from the bytes of an image file. `name`: for messages.
LoadedImage decodeGreyImage(std::span<const uint8_t> bytes, const std::string& name,
                            const GreyRange& range = {});

/// Pixels as a file stores them; empty where it cannot be read.
cv::Mat decodeStoredPixels(std::span<const uint8_t> bytes);

/// The bytes of an image file.
StoredImage loadStoredImage(const std::filesystem::path& file);

/// Whether the bytes are those of a PNG file, whose pixels can be had without loss.
bool isPng(std::span<const uint8_t> bytes);

/// 8-bit grey from 8 or 16 bits, one, three (BGR) or four (BGRA) channels: luminance; 16 bits by `range`.
cv::Mat greyFrom(const cv::Mat& pixels, const GreyRange& range = {});

}  // namespace lodeline
