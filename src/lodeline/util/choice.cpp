#include "lodeline/util/choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "lodeline/diagnostics.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

}  // namespace

bool equalIgnoringCase(std::string_view a, std::string_view b) { return lowerCase(a) == lowerCase(b); }

std::string nearestName(std::string_view word, std::span<const std::string> names) {
  const std::string lower = lowerCase(word);
  std::string nearest;
  size_t least = std::max<size_t>(2, lower.size() / 3 + 1);
  for (const std::string& name : names) {
    const size_t distance = editDistance(lower, lowerCase(name));
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

std::string didYouMean(std::string_view word, std::span<const std::string> names) {
  const std::string nearest = nearestName(word, names);
  return nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest);
}

size_t chooseByName(std::string_view what, std::string_view word, std::span<const std::string> names) {
  for (size_t i = 0; i < names.size(); ++i) {
    if (equalIgnoringCase(word, names[i])) return i;
  }
  throw UsageError(fmt::format("{} '{}': one of {} is wanted{}", what, word, fmt::join(names, ", "),
                               didYouMean(word, names)));
}

}  // namespace lodeline
