#pragma once

#include <map>
#include <memory>
#include <string>

#include "lodeline/io/logs/binary/log_bytes.h"
#include "lodeline/io/logs/binary/message_log.h"

namespace lodeline {

/// A ULog file of PX4 (docs.px4.io, "ULog File Format"): a header, definitions of the messages, then the
/// messages, little endian. Each message has a size, a type and a payload. Definitions may be nested; the
/// fields of this reader have flat names. After damage, it continues at the next synchronization message.
/// Appended data are read as the flags of the file state. `file`: for messages. Throws InputError where the
/// file is no ULog file or needs a feature that is not known here.
class ULog : public MessageLog {
 public:
  ULog(std::unique_ptr<ByteSource> bytes, std::string file);

  bool next(LogMessage* message) override;

 private:
  /// A topic that has an identifier in this file.
  struct Subscription {
    LogFormat format;
    int instance = 0;
  };

  void readHeader();
  void takeFlags(std::span<const uint8_t> payload);
  void define(std::string_view text);
  void subscribe(std::span<const uint8_t> payload);
  /// Adds the fields of a definition at `offset`, and moves `offset` behind them.
  bool addFields(const std::string& definition, const std::string& prefix, int depth, size_t* offset,
                 std::vector<LogField>* fields) const;
  bool addField(std::string_view type_and_name, const std::string& prefix, int depth, size_t* offset,
                std::vector<LogField>* fields) const;
  bool isDamagedHere(size_t size, char type);
  void resynchronize();
  /// Bytes up to the start of appended data, at which a message may be cut off.
  uint64_t bytesToAppended() const;

  LogBytes bytes_;
  std::string file_;
  std::map<std::string, std::string> definitions_;  ///< "type name;type name;..." by name
  std::map<uint16_t, Subscription> subscriptions_;
  std::vector<uint64_t> appended_;  ///< offsets that were not reached yet
  size_t unread_ = 0;               ///< size of the message that was returned last
};

}  // namespace lodeline
