#include "lodeline/io/rosbag/definitions/message_text.h"

#include <fmt/format.h>

#include <iterator>

#include "lodeline/io/rosbag/definitions/field_reader.h"

namespace lodeline::definitions {
namespace {

/// CDR may pad a message to a multiple of 4 bytes.
constexpr size_t kPadding = 3;

class Printer {
 public:
  Printer(FieldReader* reader, const TypeDescription& type, size_t most_elements)
      : reader_(*reader), type_(type), most_elements_(most_elements) {}

  std::string run() {
    putMessage(type_.root());
    return std::move(text_);
  }

 private:
  template <typename... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  void putMessage(const MessageDescription& message) {
    reader_.step();
    put("{{");
    const char* separator = "";
    for (const Field& field : message.fields) {
      if (field.name == kPlaceholder) {
        reader_.skip(type_, field);
        continue;
      }
      put("{}{}: ", separator, field.name);
      putField(field);
      separator = ", ";
    }
    put("}}");
  }

  void putField(const Field& field) {
    if (field.repetition == Repetition::Single) return putElement(field);
    const uint32_t elements = reader_.count(field);
    put("[");
    for (uint32_t i = 0; i < elements; ++i) {
      if (i < most_elements_) {
        if (i > 0) put(", ");
        putElement(field);
        continue;
      }
      if (i == most_elements_) put(", … ({} elements)", elements);
      if (sizeOf(field.kind) > 0) {
        reader_.numbers(sizeOf(field.kind), elements - i);
        break;
      }
      Field element = field;
      element.repetition = Repetition::Single;
      element.count = 1;
      reader_.skip(type_, element);
    }
    put("]");
  }

  void putElement(const Field& field) {
    reader_.step();
    switch (field.kind) {
      case FieldKind::Bool:
        return put("{}", reader_.number<uint8_t>() != 0);
      case FieldKind::Int8:
        return put("{}", int{reader_.number<int8_t>()});
      case FieldKind::UInt8:
        return put("{}", unsigned{reader_.number<uint8_t>()});
      case FieldKind::Int16:
        return put("{}", reader_.number<int16_t>());
      case FieldKind::UInt16:
        return put("{}", reader_.number<uint16_t>());
      case FieldKind::Int32:
        return put("{}", reader_.number<int32_t>());
      case FieldKind::UInt32:
        return put("{}", reader_.number<uint32_t>());
      case FieldKind::Int64:
        return put("{}", reader_.number<int64_t>());
      case FieldKind::UInt64:
        return put("{}", reader_.number<uint64_t>());
      case FieldKind::Float32:
        return put("{}", reader_.number<float>());
      case FieldKind::Float64:
        return put("{}", reader_.number<double>());
      case FieldKind::String:
        return putText(reader_.text());
      case FieldKind::WideString:
        return putText(reader_.wideText());
      case FieldKind::Message:
        return putMessage(type_.messages[field.message]);
    }
  }

  void putText(std::string_view value) {
    text_ += '"';
    for (const char c : value) {
      const auto code = static_cast<unsigned char>(c);
      if (c == '\n') {
        text_ += "\\n";
      } else if (c == '"' || c == '\\') {
        text_ += '\\';
        text_ += c;
      } else if (code < 0x20 || code == 0x7F) {
        put("\\x{:02x}", code);
      } else {
        text_ += c;
      }
    }
    text_ += '"';
  }

  FieldReader& reader_;
  const TypeDescription& type_;
  size_t most_elements_;
  std::string text_;
};

}  // namespace

std::string messageText(std::span<const uint8_t> message, const TypeDescription& type,
                        Serialization serialization, size_t most_elements) {
  FieldReader reader(message, serialization);
  std::string text = Printer(&reader, type, most_elements).run();
  const size_t rest = reader.position() < message.size() ? message.size() - reader.position() : 0;
  if (rest > (serialization == Serialization::Cdr ? kPadding : 0)) {
    text += fmt::format(" + {} bytes that the definition does not describe", rest);
  }
  return text;
}

}  // namespace lodeline::definitions
