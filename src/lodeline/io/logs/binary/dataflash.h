#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>

#include "lodeline/io/logs/binary/log_bytes.h"
#include "lodeline/io/logs/binary/message_log.h"

namespace lodeline {

/// A DataFlash log of ArduPilot (.BIN; ardupilot.org, "LogStructure.h"): messages of a fixed length that
/// begin with 0xA3 0x95 and the number of their type. FMT messages define the types. UNIT, MULT and FMTU
/// messages state units and multipliers. After damage, the reader continues at the next message of a known
/// type. A field with the unit "#" is the instance of the sensor. `file`: for messages. Throws InputError
/// where the file does not begin as a DataFlash log.
class DataFlash : public MessageLog {
 public:
  DataFlash(std::unique_ptr<ByteSource> bytes, const std::string& file);

  bool next(LogMessage* message) override;

 private:
  struct Type {
    LogFormat format;
    size_t length = 0;              ///< of the whole message
    size_t field_count = 0;         ///< of the definition, with texts
    std::vector<size_t> positions;  ///< in the definition, for each of format.fields
    std::optional<size_t> instance_field;
  };

  void define(std::span<const uint8_t> payload);
  void takeUnit(std::span<const uint8_t> payload);
  void takeMultiplier(std::span<const uint8_t> payload);
  void takeUnitsOfType(std::span<const uint8_t> payload);
  /// Length of the message that begins here; 0 where none does.
  size_t lengthHere(std::span<const uint8_t> header) const;
  void resynchronize();

  LogBytes bytes_;
  std::array<std::unique_ptr<Type>, 256> types_;
  std::map<char, std::string> units_;
  std::map<char, double> multipliers_;
  size_t unread_ = 0;  ///< size of the message that was returned last
};

}  // namespace lodeline
