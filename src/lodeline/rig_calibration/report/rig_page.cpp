#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lodeline/cameras/camera_file_keys.h"
#include "lodeline/io/calibration/camera_keys.h"
#include "lodeline/rig_calibration/report/rig_report.h"

namespace lodeline {
namespace {

const char* const kStyle =
    R"(body{font:16px/1.5 system-ui,sans-serif;max-width:1200px;margin:2rem auto;padding:0 1rem;color:#222}
pre{background:#f6f7f9;padding:1rem;overflow-x:auto;font-size:13px;line-height:1.45}
.verdict{display:inline-block;padding:.2rem .8rem;border-radius:.3rem;color:#fff;font-weight:600}
.good{background:#2e7d32}.usable{background:#b26a00}.poor{background:#b3261e}
.pictures{display:grid;grid-template-columns:repeat(auto-fit,minmax(340px,1fr));gap:1rem}
figure{margin:0}figure img{width:100%;height:auto}figcaption{font-size:14px;color:#555}
@media (prefers-color-scheme:dark){body{background:#16181c;color:#ddd}pre{background:#22252b}figure{background:#fff}})";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '<') {
      result += "&lt;";
    } else if (c == '&') {
      result += "&amp;";
    } else {
      result += c;
    }
  }
  return result;
}

/// The drawing as an address that a page shows without another file.
std::string addressOf(const std::string& svg) {
  std::string address = "data:image/svg+xml,";
  for (const char c : svg) {
    if (c == '%' || c == '#' || c == '"' || c == '<' || c == '>' || c == '\n') {
      address += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    } else {
      address += c;
    }
  }
  return address;
}

std::string matrixText(const char* key, const Rigid3& transform) {
  const Eigen::Matrix4d m = transform.matrix();
  std::string text = fmt::format("  {}:\n", key);
  for (int row = 0; row < 4; ++row)
    text += fmt::format("  - [{}, {}, {}, {}]\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
  return text;
}

}  // namespace

std::string rigCalibrationPage(const std::string& text, const RigCalibrationResult& result,
                               const std::vector<ReportPicture>& pictures) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>Calibration of cameras</title>\n<style>";
  page += kStyle;
  page += fmt::format(
      "</style></head><body>\n<h1>Calibration of cameras</h1>\n<p><span class=\"verdict {0}\">{0}"
      "</span></p>\n",
      toString(result.verdict));
  if (!result.doubts.empty()) {
    page += "<ul>\n";
    for (const CalibrationDoubt& doubt : result.doubts)
      page += fmt::format("<li>{}: {}</li>\n", toString(doubt.verdict), escaped(doubt.text));
    page += "</ul>\n";
  }
  page += "<div class=\"pictures\">\n";
  for (const ReportPicture& picture : pictures) {
    page += fmt::format("<figure><img alt=\"\" src=\"{}\"><figcaption>{}</figcaption></figure>\n",
                        addressOf(picture.svg), escaped(picture.caption));
  }
  page += fmt::format("</div>\n<h2>All figures</h2>\n<pre>{}</pre>\n</body></html>\n", escaped(text));
  return page;
}

std::string camchainText(const RigCalibrationResult& result) {
  std::string text;
  for (size_t k = 0; k < result.cameras.size(); ++k) {
    const CameraCalibration& c = result.cameras[k].calibration;
    const CameraFileKeys keys = cameraFileKeys(c);
    text += fmt::format("{}:\n", c.name);
    if (result.inertial) text += matrixText("T_cam_imu", c.body_from_camera.inverse());
    if (k > 0) {
      const CameraCalibration& before = result.cameras[k - 1].calibration;
      text += matrixText("T_cn_cnm1", c.body_from_camera.inverse() * before.body_from_camera);
    }
    // Kalibr uses other names for two distortion models.
    const bool is_radial = keys.distortion_model == "radial-tangential";
    text += fmt::format(
        "  camera_model: {}\n  intrinsics: [{}]\n  distortion_model: {}\n  distortion_coeffs: [{}]\n",
        keys.camera_model, fmt::join(keys.intrinsics, ", "), is_radial ? "radtan" : keys.distortion_model,
        fmt::join(keys.distortion_coefficients, ", "));
    text += fmt::format("  resolution: [{}, {}]\n", c.width_px, c.height_px);
    if (result.inertial) text += fmt::format("  timeshift_cam_imu: {}\n", c.time_offset_to_imu_s);
    if (c.port) text += fmt::format("  port: {}\n", portText(*c.port));
  }
  return text;
}

}  // namespace lodeline
