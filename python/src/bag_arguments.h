#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/pipeline/open_recording.h"

namespace lodeline::python {

/// The options of the command line on a recording's sensors, from their form in Python.
inline BagArguments bagArguments(const std::vector<std::filesystem::path>& rig,
                                 const std::map<std::string, std::string>& topics, bool received_times) {
  BagArguments arguments;
  for (const std::filesystem::path& file : rig) arguments.rig_files.push_back(file.string());
  for (const auto& [sensor, topic] : topics) arguments.topics.push_back(sensor + "=" + topic);
  arguments.use_received_times = received_times;
  return arguments;
}

}  // namespace lodeline::python
