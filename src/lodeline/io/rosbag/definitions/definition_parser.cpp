#include "lodeline/io/rosbag/definitions/definition_parser.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>

#include "lodeline/io/rosbag/definitions/known_definitions.h"

namespace lodeline::definitions {
namespace {

constexpr size_t kMostMessages = 1000;
constexpr size_t kMostFields = 10'000;
constexpr size_t kDeepest = 32;
constexpr std::string_view kBlank = " \t\r";

struct Primitive {
  std::string_view name;
  FieldKind kind;
};

constexpr std::array kPrimitives = {
    Primitive{"bool", FieldKind::Bool},          Primitive{"byte", FieldKind::UInt8},
    Primitive{"char", FieldKind::UInt8},         Primitive{"int8", FieldKind::Int8},
    Primitive{"uint8", FieldKind::UInt8},        Primitive{"int16", FieldKind::Int16},
    Primitive{"uint16", FieldKind::UInt16},      Primitive{"int32", FieldKind::Int32},
    Primitive{"uint32", FieldKind::UInt32},      Primitive{"int64", FieldKind::Int64},
    Primitive{"uint64", FieldKind::UInt64},      Primitive{"float32", FieldKind::Float32},
    Primitive{"float64", FieldKind::Float64},    Primitive{"string", FieldKind::String},
    Primitive{"wstring", FieldKind::WideString},
};

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Removes and returns the first line of `text`.
std::string_view takeLine(std::string_view* text) {
  const size_t end = text->find('\n');
  const std::string_view line = text->substr(0, end);
  *text = end == std::string_view::npos ? std::string_view() : text->substr(end + 1);
  return line;
}

bool isSeparator(std::string_view line) {
  return line.size() >= 10 && line.find_first_not_of('=') == std::string_view::npos;
}

std::optional<uint32_t> numberOf(std::string_view text) {
  uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// A field before its type is looked up.
struct RawField {
  std::string type;
  Field field;
};

/// Parses "TYPE[N] NAME DEFAULT"; nothing for constants, comments and empty lines.
std::optional<RawField> parseField(std::string_view line) {
  line = trimmed(line.substr(0, line.find('#')));
  if (line.empty()) return std::nullopt;
  const size_t type_end = line.find_first_of(kBlank);
  if (type_end == std::string_view::npos) throw DefinitionError(fmt::format("line '{}' has no name", line));
  std::string_view type = line.substr(0, type_end);
  const std::string_view rest = trimmed(line.substr(type_end));
  const size_t name_end = std::min(rest.find_first_of(" \t="), rest.size());
  if (trimmed(rest.substr(name_end)).starts_with('=')) return std::nullopt;  // a constant
  RawField raw;
  raw.field.name = rest.substr(0, name_end);
  const size_t bracket = type.find('[');
  if (bracket != std::string_view::npos) {
    const std::string_view count = type.substr(bracket + 1, type.find(']') - bracket - 1);
    raw.field.repetition = Repetition::Variable;
    if (!count.empty() && !count.starts_with("<=")) {
      const std::optional<uint32_t> number = numberOf(count);
      if (!number) throw DefinitionError(fmt::format("'{}' is no number of elements", count));
      raw.field.repetition = Repetition::Fixed;
      raw.field.count = *number;
    }
    type = type.substr(0, bracket);
  }
  raw.type = type.substr(0, type.find("<="));
  return raw;
}

/// The definitions in a text by type.
std::map<std::string, std::string_view, std::less<>> sectionsOf(const std::string& type,
                                                                std::string_view text) {
  std::map<std::string, std::string_view, std::less<>> sections;
  std::string name = type;
  const char* start = text.data();
  std::string_view rest = text;
  const auto store = [&](const char* end) {
    sections.try_emplace(name, start, static_cast<size_t>(end - start));
  };
  while (!rest.empty()) {
    const std::string_view line = takeLine(&rest);
    if (!isSeparator(trimmed(line))) continue;
    store(line.data());
    const std::string_view head = trimmed(takeLine(&rest));
    if (head.starts_with("IDL:")) throw DefinitionError("is in IDL form");
    if (!head.starts_with("MSG:")) throw DefinitionError("has a separator without 'MSG:'");
    name = shortTypeName(trimmed(head.substr(4)));
    start = rest.data();
  }
  if (start != nullptr) store(text.data() + text.size());
  return sections;
}

class Parser {
 public:
  Parser(const std::string& type, std::string_view text, Serialization serialization)
      : serialization_(serialization), sections_(sectionsOf(type, text)) {
    const auto own = sections_.find(type);
    if (own != sections_.end() && trimmed(own->second).empty() && knownFields(type, serialization)) {
      sections_.erase(own);
    }
    if (type.find("/srv/") != std::string::npos) splitService(type);
  }

  TypeDescription run(const std::string& type) {
    add(type, 0);
    return std::move(result_);
  }

 private:
  /// The fields of the event, the request and the response of a service.
  void splitService(const std::string& type) {
    constexpr std::string_view kEvent = "_Event";
    const std::string_view name = type;
    if (!name.ends_with(kEvent)) return;
    const std::string service(name.substr(0, name.size() - kEvent.size()));
    const auto own = sections_.find(type);
    if (own == sections_.end()) return;
    std::string_view rest = own->second;
    const char* start = rest.data();
    while (!rest.empty()) {
      const std::string_view line = takeLine(&rest);
      if (trimmed(line) != "---") continue;
      sections_[service + "_Request"] = {start, static_cast<size_t>(line.data() - start)};
      sections_[service + "_Response"] = rest;
      event_ = fmt::format(
          "service_msgs/ServiceEventInfo info\n{0}_Request[<=1] request\n"
          "{0}_Response[<=1] response\n",
          service);
      own->second = event_;
      return;
    }
  }

  std::string_view fieldsOf(const std::string& type) const {
    const auto section = sections_.find(type);
    if (section != sections_.end()) return section->second;
    const std::optional<std::string_view> known = knownFields(type, serialization_);
    if (!known) throw DefinitionError(fmt::format("does not describe {}", type));
    return *known;
  }

  /// Full name of a type in a field of `message`, whose package may be left out.
  std::string nameInside(const std::string& message, const std::string& type) const {
    if (type == "time") return "builtin_interfaces/Time";
    if (type == "duration") return "builtin_interfaces/Duration";
    if (type == "Header") return "std_msgs/Header";
    if (type.find('/') != std::string::npos) return shortTypeName(type);
    return fmt::format("{}/{}", message.substr(0, message.find('/')), type);
  }

  size_t add(const std::string& type, size_t depth) {
    const auto known = places_.find(type);
    if (known != places_.end()) {
      if (is_open_[known->second]) throw DefinitionError(fmt::format("{} contains itself", type));
      return known->second;
    }
    if (depth > kDeepest || result_.messages.size() >= kMostMessages) throw DefinitionError("is too large");
    const size_t place = result_.messages.size();
    places_[type] = place;
    result_.messages.push_back({type, {}});
    is_open_.push_back(true);
    std::vector<Field> fields;
    std::string_view rest = fieldsOf(type);
    while (!rest.empty()) {
      std::optional<RawField> raw = parseField(takeLine(&rest));
      if (!raw) continue;
      if (++field_count_ > kMostFields) throw DefinitionError("has too many fields");
      settleKind(type, &*raw, depth);
      fields.push_back(std::move(raw->field));
    }
    // ROS 2 gives a message without fields one byte.
    if (fields.empty() && serialization_ == Serialization::Cdr) {
      Field dummy;
      dummy.name = kPlaceholder;
      fields.push_back(dummy);
    }
    result_.messages[place].fields = std::move(fields);
    is_open_[place] = false;
    return place;
  }

  void settleKind(const std::string& message, RawField* raw, size_t depth) {
    const auto* primitive = std::find_if(kPrimitives.begin(), kPrimitives.end(),
                                         [&](const Primitive& known) { return known.name == raw->type; });
    if (primitive != kPrimitives.end()) {
      raw->field.kind = primitive->kind;
      return;
    }
    raw->field.kind = FieldKind::Message;
    raw->field.message = add(nameInside(message, raw->type), depth + 1);
  }

  Serialization serialization_;
  std::map<std::string, std::string_view, std::less<>> sections_;
  std::string event_;
  std::map<std::string, size_t> places_;
  std::vector<bool> is_open_;
  size_t field_count_ = 0;
  TypeDescription result_;
};

}  // namespace

std::string shortTypeName(std::string_view type) {
  constexpr std::string_view kMiddle = "/msg/";
  const size_t middle = type.find(kMiddle);
  if (middle == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, middle)) + "/" + std::string(type.substr(middle + kMiddle.size()));
}

TypeDescription parseDefinition(const std::string& type, std::string_view text, Serialization serialization) {
  return Parser(type, text, serialization).run(type);
}

}  // namespace lodeline::definitions
