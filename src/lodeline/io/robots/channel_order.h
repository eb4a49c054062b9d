#pragma once

#include <string>
#include <vector>

namespace lodeline {

/// For each channel of the calibration its place among the `found` names of a recording. Without a
/// calibration
/// (`wanted` is empty), the order is that of the recording. Throws InputError, beginning with `where`, where
/// a name is found twice, or where the two do not have the same names.
std::vector<size_t> channelOrder(const std::string& where, const std::vector<std::string>& found,
                                 const std::vector<std::string>& wanted);

}  // namespace lodeline
