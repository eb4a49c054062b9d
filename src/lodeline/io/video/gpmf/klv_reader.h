#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lodeline::gpmf {

/// One element of GPMF: four characters of a key, one of a type, the size of a sample, their number, and the
/// bytes, all big-endian. Source of the format: the documentation of gopro/gpmf-parser.
struct Element {
  std::string key;
  char type = '\0';      ///< '\0': the bytes are elements
  uint8_t size = 0;      ///< bytes of a sample
  uint16_t repeats = 0;  ///< number of samples
  std::span<const uint8_t> bytes;

  bool isNested() const { return type == '\0'; }
};

/// Reads the elements of a payload, or those within another element, one after the other. An element that
/// ends after the bytes ends the reading; so do zeros, with which cameras fill payloads up.
class ElementReader {
 public:
  explicit ElementReader(std::span<const uint8_t> bytes) : rest_(bytes) {}

  std::optional<Element> next();
  /// Why the reading ended early; empty where it did not.
  const std::string& problem() const { return problem_; }

 private:
  std::span<const uint8_t> rest_;
  std::string problem_;
};

/// Bytes of one number or text of a type; nothing for an unknown type.
std::optional<size_t> sizeOf(char type);

/// The types of the fields of a sample from the text of TYPE: "f[3]L" gives "fffL". Empty for a text that is
/// no list of types, or that gives more fields than a sample has bytes.
std::string expandedTypes(const std::string& text);

/// The numbers of an element, sample by sample. Fields that are no numbers (characters, IDs, dates) become
/// NaN. `types`: of the fields of a sample for type '?', see expandedTypes(). Returns nothing where types and
/// sizes do not fit together.
std::optional<std::vector<double>> numbersOf(const Element& element, const std::string& types = {});

/// Text without the zeros at its end, converted from Latin-1 to UTF-8.
std::string textOf(const Element& element);

}  // namespace lodeline::gpmf
