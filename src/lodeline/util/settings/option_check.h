#pragma once

#include <string>
#include <string_view>
#include <utility>

namespace lodeline {

/// Checks the values of an options struct. Each function throws UsageError, with the name and the value,
/// where the value is not a finite number within the range.
class OptionCheck {
 public:
  /// `section`: what comes before the names in messages, for example "window".
  explicit OptionCheck(std::string section) : section_(std::move(section)) {}

  const OptionCheck& positive(std::string_view name, double value) const;
  const OptionCheck& notNegative(std::string_view name, double value) const;
  const OptionCheck& atLeast(std::string_view name, double value, double least) const;
  const OptionCheck& within(std::string_view name, double value, double least, double greatest) const;

 private:
  void require(bool is_right, std::string_view name, double value, const std::string& range) const;
  std::string section_;
};

}  // namespace lodeline
