#pragma once

namespace CLI {
class App;
}

namespace lodeline {

/// `lodeline convert-calibration` and `lodeline rig-template`.
void addConvertCalibrationCommand(CLI::App& program);
void addRigTemplateCommand(CLI::App& program);

}  // namespace lodeline
