#pragma once

#include <string_view>

namespace lodeline {

/// The page without data, as web/ was bundled when the program was built; empty where it was built without
/// (LODELINE_REPORT=OFF, or no npm).
std::string_view pageTemplate();

}  // namespace lodeline
