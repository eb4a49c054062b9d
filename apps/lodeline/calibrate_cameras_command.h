#pragma once

namespace CLI {
class App;
}

namespace lodeline {

/// Adds `cameras` to the command `calibrate`.
void addCalibrateCamerasCommand(CLI::App& calibrate_command);

}  // namespace lodeline
