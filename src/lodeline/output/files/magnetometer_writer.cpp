#include "lodeline/output/files/magnetometer_writer.h"

#include <fmt/ostream.h>

#include "lodeline/util/files/output_file.h"

namespace lodeline {

MagnetometerWriter::MagnetometerWriter(const std::filesystem::path& folder,
                                       const MagnetometerCalibration& calibration)
    : calibration_(calibration), stream_(openOutput(folder / "magnetometer.csv")) {
  stream_ << "#timestamp [ns],read_x [T],read_y [T],read_z [T],corrected_x [T],corrected_y [T],corrected_z "
             "[T]\n";
}

void MagnetometerWriter::write(const FramePacket& packet) {
  const std::vector<MagnetometerSample>& readings = packet.readings.of<MagnetometerSample>();
  if (readings.empty()) return;
  const MagnetometerSample& sample = readings.back();
  const Vec3& read = sample.field_M;
  const Vec3 corrected = calibration_.corrected_B(read);
  fmt::print(stream_, "{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", sample.time.nanoseconds(), read.x(),
             read.y(), read.z(), corrected.x(), corrected.y(), corrected.z());
}

}  // namespace lodeline
