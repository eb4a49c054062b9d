#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lodeline/node/messages/message_writer.h"

namespace lodeline {

/// Content of diagnostic_msgs/DiagnosticStatus.
struct DiagnosticStatus {
  enum Level : uint8_t { kOk = 0, kWarn = 1, kError = 2 };

  Level level = kOk;
  std::string name;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;  ///< by key

  void add(std::string key, std::string value) { values.emplace_back(std::move(key), std::move(value)); }
};

/// diagnostic_msgs/DiagnosticArray
wire::Bytes diagnosticsMessage(Time time, const std::vector<DiagnosticStatus>& statuses,
                               definitions::Serialization serialization);

}  // namespace lodeline
