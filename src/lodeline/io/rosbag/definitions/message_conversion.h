#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/io/rosbag/definitions/field_reader.h"
#include "lodeline/io/rosbag/definitions/field_writer.h"
#include "lodeline/io/rosbag/definitions/type_description.h"

namespace lodeline::definitions {

/// A type with the serialization of its messages.
struct MessageForm {
  TypeDescription type;
  Serialization serialization = Serialization::Ros1;
  /// Whether the other form of the type may lack fields, or have them as another kind; they become 0.
  bool may_be_filled = false;
  /// Whether messages must end with their last field: true where the definition may be that of another
  /// version.
  bool must_fit = false;
};

/// Converts messages between two forms of a type, field by field, by the names of the fields (capital letters
/// do not matter: CameraInfo has K in ROS 1 and k in ROS 2). Fields that only the old form has are dropped.
/// The sequence number of a header, which ROS 2 does not have, becomes 0; so do all fields that the old form
/// lacks where the new form may be filled.
class MessageConversion {
 public:
  /// Throws DefinitionError where the old form lacks another field of the new form, or has it as another kind
  /// of number.
  MessageConversion(MessageForm from, MessageForm to);

  /// Throws wire::Reader::CutOff and DefinitionError as FieldReader does.
  wire::Bytes convert(std::span<const uint8_t> message) const;

 private:
  /// How a message of the new form is made of one of the old form.
  struct Plan {
    size_t from = 0, to = 0;                     ///< places of the messages in both types
    std::vector<std::optional<size_t>> sources;  ///< per new field, the old field
    std::vector<size_t> inner;                   ///< per new field, the plan of its message
    bool is_in_order = true;                     ///< whether the old fields can be read one after the other
  };

  size_t makePlan(size_t from, size_t to, const std::string& path);
  void run(const Plan& plan, FieldReader* reader, FieldWriter* writer) const;
  void copy(const Field& from, const Field& to, size_t inner, FieldReader* reader, FieldWriter* writer) const;

  MessageForm from_, to_;
  std::vector<Plan> plans_;
  size_t root_ = 0;
};

/// Form of a common type with Lodeline's built-in definition. Messages of a type with versions may be filled
/// in ROS 1's form and must fit as CDR. Throws DefinitionError for an unknown type.
MessageForm knownForm(const std::string& type, Serialization serialization);

}  // namespace lodeline::definitions
