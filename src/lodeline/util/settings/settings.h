#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace lodeline {

/// Binds the members of options structs to the keys of a YAML configuration. Keys are dotted paths whose last
/// part carries the unit, for example "front_end.max_gap_s". In a file, the dots become nested maps.
///
///     Settings settings;
///     settings.bind("front_end.max_features", &options.max_features, "features kept per image");
///     settings.bind("magnetometer.model", &options.model,
///                   {{"paper", Model::Paper}, {"off", Model::Off}}, "…");
///     settings.load("config.yaml");
///     settings.set("front_end.max_features", "400");  // the command line is applied last and wins
///     settings.write(stream);  // the values in effect, as a valid configuration
///
/// Keys that begin with "expert." are the second tier of settings; that part may be left out.
///
/// A wrong key or value throws UsageError. The message has the place (file and line, or command line), the
/// key and a correction: the nearest known key, or the expected kind of value.
class Settings {
 public:
  enum class Sign { NotNegative, Positive };

  /// `target` holds the default value and must outlive the settings. Numbers must be finite.
  void bind(const std::string& key, bool* target, const std::string& documentation);
  /// Binds a count; `least` is the smallest valid value.
  void bind(const std::string& key, int* target, const std::string& documentation, int least = 0);
  /// Binds a size, time or sigma; none may be negative.
  void bind(const std::string& key, double* target, const std::string& documentation,
            Sign sign = Sign::NotNegative);
  void bind(const std::string& key, std::string* target, const std::string& documentation);
  void bind(const std::string& key, std::vector<double>* target, const std::string& documentation);
  void bind(const std::string& key, std::vector<int>* target, const std::string& documentation);

  /// Binds an enumeration by the names used in the configuration. Every value of `target` must have a name.
  template <typename Enum>
  void bind(const std::string& key, Enum* target, std::initializer_list<std::pair<const char*, Enum>> names,
            const std::string& documentation);

  void load(const std::filesystem::path& file);

  /// Sets one key. `value` has YAML syntax: "3", "true", "[1, 2]".
  void set(const std::string& key, const std::string& value);

  /// Writes all keys in the order of binding, grouped by section, with their documentation as comments.
  /// Doubles keep all their bits when read back.
  void write(std::ostream& stream) const;

 private:
  /// A configured value as text: one scalar or a list of scalars.
  struct Text {
    bool is_list = false;
    std::vector<std::string> scalars;
  };
  struct Entry {
    std::string key;
    std::string documentation;
    std::string kind;                        ///< expected kind of value for error messages, e.g. "a number"
    std::function<bool(const Text&)> parse;  ///< stores the value; false for an invalid one
    std::function<std::string()> format;
  };
  struct Assignment {
    std::string key;
    std::string place;
    Text value;
  };
  class FileReader;

  void add(Entry entry);
  template <typename Number, typename Fits>
  void addNumber(const std::string& key, Number* target, const std::string& documentation,
                 const std::string& kind, Fits fits);
  template <typename Number>
  void addList(const std::string& key, std::vector<Number>* target, const std::string& documentation,
               const std::string& kind);
  void addChoice(const std::string& key, const std::string& documentation, std::vector<std::string> names,
                 std::function<void(size_t)> store, std::function<size_t()> current);
  void apply(const Assignment& assignment);
  bool isSection(const std::string& path) const;
  const Entry* find(const std::string& key) const;
  std::string nearestKey(const std::string& key) const;

  std::vector<Entry> entries_;
};

template <typename Enum>
void Settings::bind(const std::string& key, Enum* target,
                    std::initializer_list<std::pair<const char*, Enum>> names,
                    const std::string& documentation) {
  std::vector<std::string> texts;
  std::vector<Enum> values;
  for (const auto& [text, value] : names) {
    texts.emplace_back(text);
    values.push_back(value);
  }
  addChoice(
      key, documentation, std::move(texts), [target, values](size_t i) { *target = values[i]; },
      [target, values] {
        size_t i = 0;
        while (i < values.size() && values[i] != *target) ++i;
        return i;
      });
}

}  // namespace lodeline
