#pragma once

#include <any>
#include <string>
#include <utility>
#include <vector>

namespace lodeline {

/// What a sensor reports about a frame, in words and numbers for files and summaries.
struct SensorRow {
  std::string sensor;
  std::string status;
  std::vector<std::pair<std::string, std::string>> columns;  ///< of states.csv: name with unit, value
};

/// What the sensors report about a frame: one estimate of each kind at most.
class SensorEstimates {
 public:
  /// The estimate of a kind; the default one where there is none.
  template <typename Kind>
  const Kind& of() const {
    static const Kind none;
    const Kind* found = find<Kind>();
    return found ? *found : none;
  }
  /// The same to be changed; added where there is none.
  template <typename Kind>
  Kind& of() {
    if (const Kind* found = find<Kind>()) return const_cast<Kind&>(*found);
    return std::any_cast<Kind&>(items_.emplace_back(Kind()));
  }
  template <typename Kind>
  void set(Kind estimate) {
    of<Kind>() = std::move(estimate);
  }

 private:
  template <typename Kind>
  const Kind* find() const {
    for (const std::any& item : items_) {
      if (const auto* found = std::any_cast<Kind>(&item)) return found;
    }
    return nullptr;
  }
  std::vector<std::any> items_;
};

}  // namespace lodeline
