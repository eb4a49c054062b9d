#include "lodeline/output/report/summary_lines.h"

#include <fmt/format.h>

#include <algorithm>

namespace lodeline {

void SummaryLines::add(const std::string& name, const std::string& value) {
  constexpr size_t kNameWidth = 14;
  const size_t width = value_width_ > 0 ? value_width_ : value.size() + 1;
  std::string first = fmt::format("  {:<{}} ", name, kNameWidth);
  for (size_t begin = 0; begin < value.size();) {
    size_t end = std::min(begin + width, value.size());
    if (end < value.size()) {
      const size_t blank = value.rfind(' ', end);
      // Words longer than a line are not split.
      end =
          blank != std::string::npos && blank > begin ? blank : std::min(value.find(' ', end), value.size());
    }
    text_ += first + value.substr(begin, end - begin) + "\n";
    first.assign(first.size(), ' ');
    begin = value.find_first_not_of(' ', end);
    if (begin == std::string::npos) break;
  }
  if (value.empty()) text_ += first + "\n";
}

}  // namespace lodeline
