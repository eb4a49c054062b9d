#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/current_table.h"
#include "lodeline/io/euroc/dvl_table.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/euroc/image_list.h"
#include "lodeline/io/images/grey_range.h"
#include "lodeline/recording.h"

namespace lodeline {

/// A recording in the EuRoC ASL layout, read as a stream: memory holds only a few rows at any length.
///
///     mav0/camN/data.csv       #timestamp [ns],filename      (the name may be missing: STAMP.png then;
///                                                            without the file see ImageList)
///     mav0/imu0/data.csv       #timestamp [ns],w x y z [rad/s],a x y z [m/s^2]
///     mav0/mag0/data.csv       #timestamp [ns],m_x [T],m_y [T],m_z [T]
///     mav0/pressure0/data.csv  #timestamp [ns],depth [m]     (positive down)
///     mav0/sonar0/data.csv     #timestamp [ns],range [m],angle [rad]
///     mav0/altimeter0/data.csv #timestamp [ns],range [m]
///     mav0/dvl0/data.csv       see DvlTable
///     mav0/current0/data.csv   see CurrentTable
///
/// Each folder has its sensor.yaml (see readEurocRig).
class EurocSource : public RecordedSource {
 public:
  /// `data`: the folder that contains mav0, or mav0 itself. `diagnostics` must outlive the source. Throws
  /// InputError like findEurocLayout() and readEurocRig().
  EurocSource(const std::filesystem::path& data, const EurocOptions& options, Diagnostics* diagnostics);

  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<DepthSample> nextDepth() override;
  std::optional<SonarSample> nextSonar() override;
  std::optional<double> shareRead() const override;
  std::optional<AltimeterSample> nextAltimeter() override;
  std::optional<DvlSample> nextDvl() override;
  std::optional<CurrentSample> nextCurrents() override;

 private:
  EurocSource(const EurocLayout& layout, Diagnostics* diagnostics);
  GreyRange measureGreyRange(size_t camera);
  EurocSource(EurocLayout layout, const RigFile& described, Diagnostics* diagnostics);
  void checkMagneticUnit(const MagnetometerSample& sample);

  EurocLayout layout_;
  Diagnostics* diagnostics_;
  std::optional<CsvReader> imu_;
  std::vector<ImageList> cameras_;
  std::vector<std::optional<GreyRange>> grey_ranges_;  ///< per camera, measured at its first image
  std::optional<CsvReader> magnetometer_;
  std::optional<CsvReader> pressure_;
  std::optional<CsvReader> sonar_;
  std::optional<CsvReader> altimeter_;
  std::unique_ptr<DvlTable> dvl_;
  std::unique_ptr<CurrentTable> currents_;
  bool is_magnetic_unit_doubted_ = false;  ///< already reported for the whole column
  CsvRow row_;                             ///< reused to avoid allocation
};

}  // namespace lodeline
