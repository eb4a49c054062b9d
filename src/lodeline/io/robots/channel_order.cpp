#include "lodeline/io/robots/channel_order.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

std::vector<std::string> missingFrom(const std::vector<std::string>& names,
                                     const std::vector<std::string>& wanted) {
  std::vector<std::string> missing;
  for (const std::string& name : wanted) {
    if (std::find(names.begin(), names.end(), name) == names.end()) missing.push_back(name);
  }
  return missing;
}

}  // namespace

std::vector<size_t> channelOrder(const std::string& where, const std::vector<std::string>& found,
                                 const std::vector<std::string>& wanted) {
  for (size_t i = 0; i < found.size(); ++i) {
    if (std::find(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(i), found[i]) ==
        found.begin() + static_cast<std::ptrdiff_t>(i))
      continue;
    throw InputError(fmt::format("{}: has two channels with the name '{}'", where, found[i]));
  }
  std::vector<size_t> order(found.size());
  std::iota(order.begin(), order.end(), size_t{0});
  if (wanted.empty()) return order;
  const std::vector<std::string> missing = missingFrom(found, wanted);
  const std::vector<std::string> unknown = missingFrom(wanted, found);
  if (!missing.empty() || !unknown.empty()) {
    throw InputError(fmt::format(
        "{}: its channels ({}) are not those of the calibration ({}){}{}; give them the same names", where,
        fmt::join(found, ", "), fmt::join(wanted, ", "),
        missing.empty() ? "" : fmt::format("; missing: {}", fmt::join(missing, ", ")),
        unknown.empty() ? "" : fmt::format("; unknown: {}", fmt::join(unknown, ", "))));
  }
  for (size_t i = 0; i < wanted.size(); ++i) {
    order[i] = static_cast<size_t>(std::find(found.begin(), found.end(), wanted[i]) - found.begin());
  }
  return order;
}

}  // namespace lodeline
