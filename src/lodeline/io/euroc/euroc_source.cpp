#include "lodeline/io/euroc/euroc_source.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/folder_calibration.h"
#include "lodeline/io/images/image_loader.h"

namespace lodeline {
namespace {

/// Bounds of plausible readings: the Earth's field is 20 to 70 µT. Readings outside are in µT, nT or gauss,
/// or are raw counts.
constexpr double kLeastField_T = 1e-6;
constexpr double kGreatestField_T = 2e-3;

bool next(std::optional<CsvReader>* reader, CsvRow* row) { return *reader && (*reader)->next(row); }

}  // namespace

EurocSource::EurocSource(const std::filesystem::path& data, const EurocOptions& options,
                         Diagnostics* diagnostics)
    : EurocSource(findEurocLayout(data, options), diagnostics) {}

EurocSource::EurocSource(const EurocLayout& layout, Diagnostics* diagnostics)
    : EurocSource(layout, readFolderCalibration(layout, diagnostics), diagnostics) {}

EurocSource::EurocSource(EurocLayout layout, const RigFile& described, Diagnostics* diagnostics)
    : RecordedSource(settleEurocRig(layout, described, diagnostics), described.imu_correction),
      layout_(std::move(layout)),
      diagnostics_(diagnostics) {
  if (layout_.has_imu) imu_.emplace(layout_.csv("imu0"), CsvContent::Imu, diagnostics, kInertialRate);
  for (const CameraCalibration& camera : rig_.cameras) {
    const std::filesystem::path images = layout_.sensor(camera.name) / "data";
    if (layout_.needs_cameras && !std::filesystem::is_directory(images)) {
      throw InputError(
          fmt::format("{}: folder of images missing; unpack the recording completely", images.string()));
    }
    cameras_.emplace_back(layout_.sensor(camera.name), diagnostics);
  }
  grey_ranges_.resize(cameras_.size());
  if (rig_.magnetometer)
    magnetometer_.emplace(layout_.csv("mag0"), CsvContent::Magnetometer, diagnostics, kMagnetometerRate);
  if (rig_.pressure) pressure_.emplace(layout_.csv("pressure0"), CsvContent::Depth, diagnostics, kDepthRate);
  if (rig_.sonar) sonar_.emplace(layout_.csv("sonar0"), CsvContent::Sonar, diagnostics, kMagnetometerRate);
  if (rig_.altimeter)
    altimeter_.emplace(layout_.csv("altimeter0"), CsvContent::Altimeter, diagnostics, kDepthRate);
  if (rig_.dvl) dvl_ = std::make_unique<DvlTable>(layout_.csv("dvl0"), rig_.dvl->beams_D.size(), diagnostics);
  if (rig_.currents)
    currents_ = std::make_unique<CurrentTable>(layout_.csv("current0"), rig_.currents->channels, diagnostics);
}

std::optional<double> EurocSource::shareRead() const {
  double sum = 0.0;
  int streams = 0;
  const auto add = [&](std::optional<double> share) {
    sum += share.value_or(0.0);
    streams += share ? 1 : 0;
  };
  if (imu_) add(imu_->shareRead());
  for (const ImageList& camera : cameras_) add(camera.shareRead());
  if (streams == 0) return std::nullopt;
  return sum / streams;
}

std::unique_ptr<RecordedSource> openEuroc(const std::filesystem::path& data, const EurocOptions& options,
                                          Diagnostics* diagnostics) {
  return std::make_unique<EurocSource>(data, options, diagnostics);
}

std::optional<ImuSample> EurocSource::nextRecordedImu() {
  if (!next(&imu_, &row_)) return std::nullopt;
  return ImuSample{row_.time, Vec3(row_.numbers.data()), Vec3(row_.numbers.data() + 3)};
}

std::optional<PendingImage> EurocSource::nextImage(size_t camera) {
  const std::optional<ListedImage> listed = cameras_[camera].next();
  if (!listed) return std::nullopt;
  std::optional<GreyRange>& range = grey_ranges_[camera];
  if (!range) range = measureGreyRange(camera);
  return PendingImage{listed->time, listed->file.string(),
                      [file = listed->file, range = *range] { return loadGreyImage(file, range); },
                      [file = listed->file] { return loadStoredImage(file); }};
}

GreyRange EurocSource::measureGreyRange(size_t camera) {
  const std::string& name = rig_.cameras[camera].name;
  Diagnostics reported_when_read_in_earnest;
  ImageList list(layout_.sensor(name), &reported_when_read_in_earnest);
  std::vector<std::filesystem::path> files;
  const auto pixels = [&](size_t i) { return decodeStoredPixels(loadStoredImage(files[i]).file); };
  while (const std::optional<ListedImage> image = list.next()) {
    files.push_back(image->file);
    // Where the images have 8 bits, the rest of the list is not read.
    constexpr size_t kFirst = 8;
    if (files.size() == kFirst && !lodeline::measureGreyRange(kFirst, pixels)) return {};
  }
  const std::optional<GreyRange> range = lodeline::measureGreyRange(files.size(), pixels);
  reportGreyRange(name, range, diagnostics_);
  return range.value_or(GreyRange());
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

std::optional<AltimeterSample> EurocSource::nextAltimeter() {
  while (next(&altimeter_, &row_)) {
    if (row_.numbers[0] > 0.0) return AltimeterSample{row_.time, row_.numbers[0]};
    diagnostics_->report(
        Severity::Notice, "altimeter_no_echo",
        fmt::format("{}:{}: a range of {:g} m is no echo; passed over", layout_.csv("altimeter0").string(),
                    altimeter_->line(), row_.numbers[0]));
  }
  return std::nullopt;
}

std::optional<DvlSample> EurocSource::nextDvl() { return dvl_ ? dvl_->next() : std::nullopt; }

std::optional<CurrentSample> EurocSource::nextCurrents() {
  return currents_ ? currents_->next() : std::nullopt;
}

}  // namespace lodeline
