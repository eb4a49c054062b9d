#pragma once

#include <string>
#include <string_view>

namespace lodeline {

/// `text` as valid UTF-8 without control characters: each byte that is neither becomes `\\xHH`. Messages
/// quote damaged files, and JSON, pages and terminals take no bytes as they come. Line ends and tabs stay.
std::string printableText(std::string_view text);

}  // namespace lodeline
