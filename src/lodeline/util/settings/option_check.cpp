#include "lodeline/util/settings/option_check.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {

const OptionCheck& OptionCheck::positive(std::string_view name, double value) const {
  require(value > 0.0, name, value, "above 0");
  return *this;
}

const OptionCheck& OptionCheck::notNegative(std::string_view name, double value) const {
  require(value >= 0.0, name, value, "at least 0");
  return *this;
}

const OptionCheck& OptionCheck::atLeast(std::string_view name, double value, double least) const {
  require(value >= least, name, value, fmt::format("at least {:g}", least));
  return *this;
}

const OptionCheck& OptionCheck::within(std::string_view name, double value, double least,
                                       double greatest) const {
  require(value >= least && value <= greatest, name, value,
          fmt::format("from {:g} to {:g}", least, greatest));
  return *this;
}

void OptionCheck::require(bool is_right, std::string_view name, double value,
                          const std::string& range) const {
  if (is_right && std::isfinite(value)) return;
  throw UsageError(fmt::format("{}.{} must be {}, not {:g}", section_, name, range, value));
}

}  // namespace lodeline
