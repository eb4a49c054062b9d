#include "lodeline/io/rosbag/definitions/message_conversion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "lodeline/io/rosbag/definitions/definition_parser.h"
#include "lodeline/io/rosbag/definitions/known_definitions.h"

namespace lodeline::definitions {
namespace {

bool isSameName(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

bool isSameShape(const Field& a, const Field& b) {
  return a.kind == b.kind && a.repetition == b.repetition &&
         (a.repetition != Repetition::Fixed || a.count == b.count);
}

/// Whether ROS 1 has the field and ROS 2 does not.
bool isSequenceNumber(const std::string& message, const Field& field) {
  return message == "std_msgs/Header" && field.name == "seq";
}

}  // namespace

MessageConversion::MessageConversion(MessageForm from, MessageForm to)
    : from_(std::move(from)), to_(std::move(to)) {
  root_ = makePlan(0, 0, "");
}

size_t MessageConversion::makePlan(size_t from, size_t to, const std::string& path) {
  const MessageDescription& old_message = from_.type.messages[from];
  const MessageDescription& new_message = to_.type.messages[to];
  Plan plan{from, to, {}, {}, true};
  size_t last = 0;
  for (const Field& field : new_message.fields) {
    const auto source = std::find_if(old_message.fields.begin(), old_message.fields.end(),
                                     [&](const Field& other) { return isSameName(other.name, field.name); });
    plan.inner.push_back(0);
    const bool is_same = source != old_message.fields.end() && isSameShape(*source, field);
    if (source == old_message.fields.end() || (!is_same && to_.may_be_filled)) {
      if (!isSequenceNumber(new_message.name, field) && !to_.may_be_filled) {
        throw DefinitionError(fmt::format("has no field {}{}", path, field.name));
      }
      plan.sources.emplace_back();
      continue;
    }
    if (!is_same) {
      throw DefinitionError(fmt::format("has another kind of field {}{}", path, field.name));
    }
    const auto place = static_cast<size_t>(source - old_message.fields.begin());
    plan.is_in_order = plan.is_in_order && place >= last;
    last = place + 1;
    plan.sources.emplace_back(place);
    if (field.kind == FieldKind::Message) {
      plan.inner.back() = makePlan(source->message, field.message, path + field.name + ".");
    }
  }
  plans_.push_back(std::move(plan));
  return plans_.size() - 1;
}

wire::Bytes MessageConversion::convert(std::span<const uint8_t> message) const {
  FieldReader reader(message, from_.serialization);
  FieldWriter writer(to_.serialization, message.size() + 16);
  run(plans_[root_], &reader, &writer);
  constexpr size_t kPadding = 8;  // that a serializer may add at the end
  if (from_.must_fit && reader.remaining() >= kPadding) {
    throw DefinitionError(
        fmt::format("is {} bytes longer than the built-in definition of its type, so it is of another "
                    "version; record with "
                    "definitions (MCAP, or ROS 2 from Iron on)",
                    reader.remaining()));
  }
  return writer.take();
}

void MessageConversion::run(const Plan& plan, FieldReader* reader, FieldWriter* writer) const {
  const std::vector<Field>& old_fields = from_.type.messages[plan.from].fields;
  const std::vector<Field>& new_fields = to_.type.messages[plan.to].fields;
  std::vector<size_t> starts;
  size_t next = 0;  // the old field at which the reader is
  if (!plan.is_in_order) {
    for (const Field& field : old_fields) {
      starts.push_back(reader->position());
      reader->skip(from_.type, field);
    }
    starts.push_back(reader->position());
  }
  for (size_t i = 0; i < new_fields.size(); ++i) {
    if (!plan.sources[i]) {
      writer->zeros(to_.type, new_fields[i]);
      continue;
    }
    const size_t source = *plan.sources[i];
    if (!plan.is_in_order) reader->seek(starts[source]);
    for (; plan.is_in_order && next < source; ++next) reader->skip(from_.type, old_fields[next]);
    copy(old_fields[source], new_fields[i], plan.inner[i], reader, writer);
    next = source + 1;
  }
  if (!plan.is_in_order) reader->seek(starts.back());
  for (; plan.is_in_order && next < old_fields.size(); ++next) reader->skip(from_.type, old_fields[next]);
}

void MessageConversion::copy(const Field& from, const Field& to, size_t inner, FieldReader* reader,
                             FieldWriter* writer) const {
  const uint32_t elements = reader->count(from);
  if (to.repetition == Repetition::Variable) writer->count(elements);
  const size_t size = sizeOf(from.kind);
  if (size > 0) return writer->numbers(reader->numbers(size, elements), size, reader->isSwapped());
  for (uint32_t i = 0; i < elements; ++i) {
    reader->step();
    if (from.kind == FieldKind::Message) {
      run(plans_[inner], reader, writer);
    } else if (from.kind == FieldKind::String) {
      writer->text(reader->text());
    } else {
      writer->text(reader->wideText());
    }
  }
}

MessageForm knownForm(const std::string& type, Serialization serialization) {
  const bool has_versions = hasVersions(type);
  return {parseDefinition(type, "", serialization), serialization,
          has_versions && serialization == Serialization::Ros1,
          has_versions && serialization == Serialization::Cdr};
}

}  // namespace lodeline::definitions
