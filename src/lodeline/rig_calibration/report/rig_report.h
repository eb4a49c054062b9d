#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/rig_calibration/result/rig_calibration.h"

namespace lodeline {

/// Report for the user: verdict with its reasons, parameters with standard deviations, quality figures.
std::string rigCalibrationText(const RigCalibrationResult& result);

/// The same report as JSON; keys carry units.
nlohmann::ordered_json rigCalibrationJson(const RigCalibrationResult& result);

/// Three figures per camera: where the corners were found, their errors, and their mean errors over the
/// image.
std::vector<gnuplot::Figure> rigCalibrationFigures(const RigCalibrationResult& result);

/// A page with the text and the figures, which needs no other file. `pictures` are SVG texts with captions.
struct ReportPicture {
  std::string caption, svg;
};
std::string rigCalibrationPage(const std::string& text, const RigCalibrationResult& result,
                               const std::vector<ReportPicture>& pictures);

/// The cameras in Kalibr's format: `T_cam_imu`, `T_cn_cnm1`, `timeshift_cam_imu` where there is an IMU, and
/// `port`, which other programs do not know.
std::string camchainText(const RigCalibrationResult& result);

}  // namespace lodeline
