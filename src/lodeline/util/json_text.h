#pragma once

#include <string>

namespace lodeline {

/// `json` as text that every reader of JSON takes: bytes that are not UTF-8 (a path, a damaged line) become
/// the replacement character instead of an exception. `indent`: of each level; -1 for a single line.
template <typename Json>
std::string jsonText(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lodeline
