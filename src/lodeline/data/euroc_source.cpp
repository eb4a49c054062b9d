#include "lodeline/data/euroc_source.h"

#include <fmt/core.h>

#include "lodeline/base/error.h"
#include "lodeline/data/image_loader.h"

namespace lodeline {
namespace {

/// The Earth's field is 20 to 70 µT. Readings beyond these bounds are in µT, nT or gauss, or raw counts.
constexpr double kLeastField_T = 1e-6;
constexpr double kGreatestField_T = 2e-3;

bool next(std::optional<CsvReader>* reader, CsvRow* row) { return *reader && (*reader)->next(row); }

}  // namespace

EurocSource::EurocSource(const std::filesystem::path& data, const EurocOptions& options,
                         Diagnostics* diagnostics)
    : EurocSource(findEurocLayout(data, options), diagnostics) {}

EurocSource::EurocSource(EurocLayout layout, Diagnostics* diagnostics)
    : RecordedSource(readEurocRig(layout, diagnostics)),
      layout_(std::move(layout)),
      diagnostics_(diagnostics) {
  if (layout_.has_imu) imu_.emplace(layout_.csv("imu0"), CsvContent::Imu, diagnostics);
  for (const CameraCalibration& camera : rig_.cameras) {
    const std::filesystem::path images = layout_.sensor(camera.name) / "data";
    if (layout_.needs_cameras && !std::filesystem::is_directory(images)) {
      throw InputError(
          fmt::format("{}: folder of images missing; unpack the recording completely", images.string()));
    }
    cameras_.emplace_back(layout_.csv(camera.name), CsvContent::Images, diagnostics);
  }
  if (rig_.magnetometer) magnetometer_.emplace(layout_.csv("mag0"), CsvContent::Magnetometer, diagnostics);
  if (rig_.pressure) pressure_.emplace(layout_.csv("pressure0"), CsvContent::Depth, diagnostics);
  if (rig_.sonar) sonar_.emplace(layout_.csv("sonar0"), CsvContent::Sonar, diagnostics);
}

std::optional<ImuSample> EurocSource::nextImu() {
  if (!next(&imu_, &row_)) return std::nullopt;
  return ImuSample{row_.time, Vec3(row_.numbers.data()), Vec3(row_.numbers.data() + 3)};
}

std::optional<PendingImage> EurocSource::nextImage(size_t camera) {
  if (!cameras_[camera].next(&row_)) return std::nullopt;
  const std::string name = row_.text.empty() ? fmt::format("{}.png", row_.time.nanoseconds()) : row_.text;
  const std::filesystem::path file = layout_.sensor(rig_.cameras[camera].name) / "data" / name;
  return PendingImage{row_.time, file.string(), [file] { return loadGreyImage(file); },
                      [file] { return loadStoredImage(file); }};
}

std::optional<MagnetometerSample> EurocSource::nextMagnetometer() {
  if (!next(&magnetometer_, &row_)) return std::nullopt;
  const MagnetometerSample sample{row_.time, Vec3(row_.numbers.data())};
  checkMagneticUnit(sample);
  return sample;
}

void EurocSource::checkMagneticUnit(const MagnetometerSample& sample) {
  const double norm = sample.field_M.norm();
  if (is_magnetic_unit_doubted_ || (norm > kLeastField_T && norm < kGreatestField_T)) return;
  is_magnetic_unit_doubted_ = true;
  diagnostics_->report(
      Severity::Warning, "magnetometer_unit",
      fmt::format("{}:{}: a field of {:g} T; the Earth's is 2e-5 to 7e-5 T: is the column in tesla?",
                  layout_.csv("mag0").string(), magnetometer_->line(), norm));
}

std::optional<DepthSample> EurocSource::nextDepth() {
  if (!next(&pressure_, &row_)) return std::nullopt;
  return DepthSample{row_.time, row_.numbers[0]};
}

std::optional<SonarSample> EurocSource::nextSonar() {
  if (!next(&sonar_, &row_)) return std::nullopt;
  return SonarSample{row_.time, row_.numbers[0], row_.numbers[1]};
}

}  // namespace lodeline
