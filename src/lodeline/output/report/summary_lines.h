#pragma once

#include <cstddef>
#include <string>

namespace lodeline {

/// Lines "name  value" with aligned values.
class SummaryLines {
 public:
  /// `value_width`: number of characters at which values are wrapped between words; 0 for no wrapping, for
  /// programs.
  explicit SummaryLines(size_t value_width) : value_width_(value_width) {}

  void add(const std::string& name, const std::string& value);
  const std::string& text() const { return text_; }

 private:
  size_t value_width_;
  std::string text_;
};

}  // namespace lodeline
