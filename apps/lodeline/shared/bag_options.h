#pragma once

#include "lodeline/pipeline/open_recording.h"

namespace CLI {
class App;
}

namespace lodeline {

/// Adds --rig, --topic and --received-times to a command.
void addBagOptions(BagArguments* arguments, CLI::App* command);

}  // namespace lodeline
