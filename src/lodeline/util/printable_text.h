#pragma once

#include <string>
#include <string_view>

namespace lodeline {

/// `text` as valid UTF-8 without control characters. Each invalid byte and each control character becomes
/// `\\xHH`; line ends and tabs stay. Messages quote damaged files, and JSON, HTML pages and terminals do not
/// accept arbitrary bytes.
std::string printableText(std::string_view text);

}  // namespace lodeline
