#pragma once

#include <string>

namespace lodeline {

/// Serializes `json` to text that every JSON reader accepts. Bytes that are not UTF-8 (from a path or a
/// damaged line) become the replacement character instead of causing an exception. `indent` is the number of
/// blanks per level; -1 gives a single line.
template <typename Json>
std::string jsonText(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lodeline
