#include "lodeline/pipeline/calibration/calibrate_cameras.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/rig_calibration/report/rig_report.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

std::string rigFileText(const RigCalibrationResult& result, const RecordedSource& source) {
  RigFile file;
  file.rig = result.rig;
  file.has_imu = result.inertial.has_value();
  file.imu_correction = source.imuCorrection();
  if (const auto* bag = dynamic_cast<const BagSource*>(&source)) file.topics = bag->rigFile().topics;
  if (file.has_imu) return rigText(file);
  // Without an IMU, only the cameras are known, relative to the first one.
  file.rig.magnetometer.reset();
  file.rig.pressure.reset();
  file.rig.sonar.reset();
  file.rig.altimeter.reset();
  file.rig.dvl.reset();
  file.rig.currents.reset();
  return "# Calibrated without IMU: T_BS takes camera coordinates to those of the first camera.\n" +
         rigText(file);
}

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<ReportPicture> drawPictures(const RigCalibrationResult& result,
                                        const std::filesystem::path& folder, Diagnostics* diagnostics) {
  const std::vector<gnuplot::Figure> figures = rigCalibrationFigures(result);
  drawFigures(figures, folder, *diagnostics);
  std::vector<ReportPicture> pictures;
  for (const gnuplot::Figure& figure : figures) {
    const std::string svg = contentOf(folder / (figure.name + ".svg"));
    std::string caption = figure.name;
    std::replace(caption.begin(), caption.end(), '_', ' ');
    if (!svg.empty()) pictures.push_back({caption, svg});
  }
  return pictures;
}

void dropPorts(BoardRecord* record) {
  for (CameraCalibration& camera : record->rig.cameras) camera.port.reset();
}

}  // namespace

CameraCalibrationOutcome calibrateCameras(RecordedSource* source, const CameraCalibrationRequest& request,
                                          const std::filesystem::path& folder, Diagnostics* diagnostics) {
  BoardRecord record = readBoardRecord(source, request.board, request.record, diagnostics);
  if (request.without_ports) dropPorts(&record);
  const RigCalibrationResult result = calibrateRig(record, request.options, diagnostics);
  createOutputFolder(folder);
  CameraCalibrationOutcome outcome;
  outcome.text = rigCalibrationText(result);
  if (result.verdict == CalibrationVerdict::Poor) outcome.poor_because = result.doubts.front().text;
  writeOutput(folder / "rig.yaml", rigFileText(result, *source));
  writeOutput(folder / (result.inertial ? "camchain-imucam.yaml" : "camchain.yaml"), camchainText(result));
  const std::vector<ReportPicture> pictures = drawPictures(result, folder / "figures", diagnostics);
  writeOutput(folder / "report.html", rigCalibrationPage(outcome.text, result, pictures));
  writeOutput(folder / "report.txt", outcome.text + findingsText(*diagnostics));
  nlohmann::ordered_json json = rigCalibrationJson(result);
  json["findings"] = findingsJson(*diagnostics);
  writeOutput(folder / "calibration.json", jsonText(json) + "\n");
  return outcome;
}

}  // namespace lodeline
