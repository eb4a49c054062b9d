#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/lodeline_dds/transport/dds_network.h"
#include "lodeline/node/node_option.h"

namespace lodeline::dds {

struct Options {
  OptionValues session;
  NetworkOptions network;
  std::string name_space = "/lodeline";
};

/// Reads the command line. Prints the help where it is asked for; the result is then empty. Throws
/// UsageError.
std::optional<Options> readOptions(int argc, char** argv);

}  // namespace lodeline::dds
