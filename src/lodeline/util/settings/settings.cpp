#include "lodeline/util/settings/settings.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

/// Names may be given without this first part.
const std::string kExpert = "expert.";

template <typename Number>
bool parseNumber(const std::string& text, Number* number) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  Number parsed = 0;
  const auto [stop, error] = std::from_chars(begin, end, parsed);
  if (error != std::errc() || stop != end || !std::isfinite(static_cast<double>(parsed))) return false;
  *number = parsed;
  return true;
}

bool parseBool(const std::string& text, bool* value) {
  const bool yes = text == "true" || text == "yes" || text == "on";
  const bool no = text == "false" || text == "no" || text == "off";
  if (yes || no) *value = yes;
  return yes || no;
}

std::string quotedText(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n') {
      result += "\\n";
    } else {
      result += c;
    }
  }
  return result + '"';
}

}  // namespace

void Settings::bind(const std::string& key, bool* target, const std::string& documentation) {
  add({key, documentation, "true or false",
       [target](const Text& text) { return !text.is_list && parseBool(text.scalars[0], target); },
       [target] { return std::string(*target ? "true" : "false"); }});
}

template <typename Number, typename Fits>
void Settings::addNumber(const std::string& key, Number* target, const std::string& documentation,
                         const std::string& kind, Fits fits) {
  add({key, documentation, kind,
       [target, fits](const Text& text) {
         Number number = 0;
         const bool is_number = !text.is_list && parseNumber(text.scalars[0], &number) && fits(number);
         if (is_number) *target = number;
         return is_number;
       },
       [target] { return fmt::format("{}", *target); }});
}

void Settings::bind(const std::string& key, int* target, const std::string& documentation, int least) {
  addNumber(key, target, documentation, fmt::format("a whole number, {} or more", least),
            [least](int number) { return number >= least; });
}

void Settings::bind(const std::string& key, double* target, const std::string& documentation, Sign sign) {
  if (sign == Sign::Positive) {
    addNumber(key, target, documentation, "a number above 0", [](double number) { return number > 0.0; });
  } else {
    addNumber(key, target, documentation, "a number, 0 or more", [](double number) { return number >= 0.0; });
  }
}

void Settings::bind(const std::string& key, std::string* target, const std::string& documentation) {
  add({key, documentation, "a text",
       [target](const Text& text) {
         if (!text.is_list) *target = text.scalars[0];
         return !text.is_list;
       },
       [target] { return quotedText(*target); }});
}

template <typename Number>
void Settings::addList(const std::string& key, std::vector<Number>* target, const std::string& documentation,
                       const std::string& kind) {
  add({key, documentation, kind,
       [target](const Text& text) {
         std::vector<Number> numbers(text.scalars.size());
         for (size_t i = 0; i < numbers.size(); ++i) {
           if (!parseNumber(text.scalars[i], &numbers[i])) return false;
         }
         if (text.is_list) *target = std::move(numbers);
         return text.is_list;
       },
       [target] { return fmt::format("[{}]", fmt::join(*target, ", ")); }});
}

void Settings::bind(const std::string& key, std::vector<double>* target, const std::string& documentation) {
  addList(key, target, documentation, "a list of numbers, like [1, 2]");
}

void Settings::bind(const std::string& key, std::vector<int>* target, const std::string& documentation) {
  addList(key, target, documentation, "a list of whole numbers, like [1, 2]");
}

void Settings::addChoice(const std::string& key, const std::string& documentation,
                         std::vector<std::string> names, std::function<void(size_t)> store,
                         std::function<size_t()> current) {
  const std::string choices = fmt::format("one of {}", fmt::join(names, ", "));
  add({key, documentation + " O" + choices.substr(1) + ".", choices,
       [names, store = std::move(store)](const Text& text) {
         const auto found = std::find_if(names.begin(), names.end(), [&text](const std::string& name) {
           return !text.is_list && equalIgnoringCase(name, text.scalars[0]);
         });
         if (found != names.end()) store(static_cast<size_t>(found - names.begin()));
         return found != names.end();
       },
       [names, current = std::move(current)] { return names.at(current()); }});
}

void Settings::add(Entry entry) {
  if (find(entry.key) != nullptr || isSection(entry.key)) {
    throw std::logic_error("setting bound twice: " + entry.key);
  }
  entries_.push_back(std::move(entry));
}

void Settings::apply(const Assignment& assignment) {
  const Entry* entry = find(assignment.key);
  if (entry == nullptr) {
    const std::string nearest = nearestKey(assignment.key);
    throw UsageError(fmt::format("{}: unknown setting '{}'{}", assignment.place, assignment.key,
                                 nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
  if (entry->parse(assignment.value)) return;
  const std::string found = fmt::format("{}", fmt::join(assignment.value.scalars, ", "));
  throw UsageError(fmt::format("{}: setting '{}' must be {}, not '{}'", assignment.place, assignment.key,
                               entry->kind, assignment.value.is_list ? "[" + found + "]" : found));
}

const Settings::Entry* Settings::find(const std::string& key) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.key == key || entry.key == kExpert + key;
  });
  return found == entries_.end() ? nullptr : &*found;
}

bool Settings::isSection(const std::string& path) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.key.starts_with(path + ".") || entry.key.starts_with(kExpert + path + ".");
  });
}

std::string Settings::nearestKey(const std::string& key) const {
  const auto distance = [&](const Entry& entry) {
    const bool has_prefix = entry.key.starts_with(kExpert) && !key.starts_with(kExpert);
    return editDistance(key, has_prefix ? entry.key.substr(kExpert.size()) : entry.key);
  };
  const auto nearest =
      std::min_element(entries_.begin(), entries_.end(),
                       [&](const Entry& a, const Entry& b) { return distance(a) < distance(b); });
  return nearest == entries_.end() ? std::string() : nearest->key;
}

}  // namespace lodeline
