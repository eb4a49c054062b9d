#include "lodeline/node/messages/diagnostic_message.h"

namespace lodeline {

wire::Bytes diagnosticsMessage(Time time, const std::vector<DiagnosticStatus>& statuses,
                               definitions::Serialization serialization) {
  MessageWriter writer(serialization);
  writer.header(time, "");
  writer.count(statuses.size());
  for (const DiagnosticStatus& status : statuses) {
    writer.put(static_cast<uint8_t>(status.level));
    writer.text(status.name);
    writer.text(status.message);
    writer.text("");  // hardware
    writer.count(status.values.size());
    for (const auto& [key, value] : status.values) {
      writer.text(key);
      writer.text(value);
    }
  }
  return writer.take();
}

}  // namespace lodeline
