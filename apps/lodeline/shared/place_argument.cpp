#include "apps/lodeline/shared/place_argument.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {

GeodeticPosition placeFromWords(const std::vector<std::string>& words, const std::string& option) {
  const std::string text = fmt::format("{}", fmt::join(words, " "));
  std::vector<double> numbers;
  bool is_place = true;
  for (size_t begin = text.find_first_not_of(" \t,;"); begin != std::string::npos;) {
    const size_t end = std::min(text.find_first_of(" \t,;", begin), text.size());
    double number = 0.0;
    is_place = is_place && csv::parse(std::string_view(text).substr(begin, end - begin), &number) &&
               std::isfinite(number);
    numbers.push_back(number);
    begin = text.find_first_not_of(" \t,;", end);
  }
  if (!is_place || numbers.size() != 3) {
    throw UsageError(fmt::format(
        "{} {}: three numbers are wanted, LAT,LON,HEIGHT in decimal degrees and m, as 29.83,-82.60,10",
        option, text));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace lodeline
