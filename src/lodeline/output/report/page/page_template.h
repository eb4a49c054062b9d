#pragma once

#include <string_view>

namespace lodeline {

/// The page without data, as bundled from web/ when the program was built; empty where it was built without
/// it (LODELINE_REPORT=OFF, or no npm).
std::string_view pageTemplate();

}  // namespace lodeline
