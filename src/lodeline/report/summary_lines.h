#pragma once

#include <string>

namespace lodeline {

/// Lines of "name  value" with all values in one column, wrapped between words to fit a terminal.
class SummaryLines {
 public:
  void add(const std::string& name, const std::string& value);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace lodeline
