#pragma once

#include <cstddef>
#include <string>

namespace lodeline {

/// Lines of "name  value" with all values in one column.
class SummaryLines {
 public:
  /// `value_width`: values are wrapped between words to so many characters; 0 for none, as programs want
  /// them.
  explicit SummaryLines(size_t value_width) : value_width_(value_width) {}

  void add(const std::string& name, const std::string& value);
  const std::string& text() const { return text_; }

 private:
  size_t value_width_;
  std::string text_;
};

}  // namespace lodeline
