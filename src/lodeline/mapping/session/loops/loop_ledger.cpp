#include "lodeline/mapping/session/loops/loop_ledger.h"

#include <fmt/format.h>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

constexpr const char* kHeader =
    "#new_time [ns],old_time [ns],new_dive,old_dive,source,status,reason,matches,inliers,covered_share,"
    "rms [sigma],mahalanobis_squared,dx [m],dy [m],dz [m],turn [deg],sigma_dx [m],sigma_dy [m],sigma_dz [m],"
    "field_chi_squared,field_values,field_log_ratio";

}  // namespace

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

LoopLedger::LoopLedger(const std::filesystem::path& file) : file_(file), stream_(openOutput(file)) {
  stream_ << kHeader << '\n';
  flush();
}

void LoopLedger::flush() {
  stream_.flush();
  if (!stream_) throw InputError(file_.string() + ": writing failed; is the disk full?");
}

void LoopLedger::write(const Loop& loop, const LoopPlaces& places) {
  const Vec3& moved = loop.old_from_new.translation;
  const double turn_deg = so3::log(loop.old_from_new.rotation).norm() * 180.0 / M_PI;
  const Vec3 sigma = loop.covariance.diagonal().head<3>().cwiseMax(0.0).cwiseSqrt();
  stream_ << fmt::format("{},{},{},{},{},{},{},{},{},{:.3f},{:.3f},{:.3f}", places.new_time.nanoseconds(),
                         places.old_time.nanoseconds(), csvField(places.new_dive), csvField(places.old_dive),
                         loop.source, toString(loop.status), csvField(loop.reason), loop.matches,
                         loop.inliers, loop.covered_share, loop.rms_sigmas, loop.mahalanobis_squared);
  // A candidate that was never aligned has no pose.
  if (loop.inliers > 0) {
    stream_ << fmt::format(",{:.4f},{:.4f},{:.4f},{:.3f},{:.4f},{:.4f},{:.4f}", moved.x(), moved.y(),
                           moved.z(), turn_deg, sigma.x(), sigma.y(), sigma.z());
  } else {
    stream_ << ",nan,nan,nan,nan,nan,nan,nan";
  }
  if (loop.field) {
    stream_ << fmt::format(",{:.2f},{},{:.2f}\n", loop.field->chi_squared, loop.field->values,
                           loop.field->log_ratio);
  } else {
    stream_ << ",nan,0,nan\n";
  }
  flush();
}

}  // namespace lodeline
