#include "lodeline/mapping/session/tags/control_report.h"

#include <fmt/format.h>

#include "lodeline/mapping/control/control_residual.h"
#include "lodeline/mapping/session/loops/loop_ledger.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

constexpr const char* kControlHeader =
    "#name,kind,time [ns],east [m],north [m],up [m],sigma_east [m],sigma_north [m],sigma_up [m],chi_squared,"
    "blunder\n";

}  // namespace

void writeControlReport(const std::filesystem::path& file, const MapFile& map) {
  const std::vector<ControlFactor> factors = controlFactorsOf(map);
  if (factors.empty()) return;
  std::string text = kControlHeader;
  const auto poseOf = [&](KeyframeId id) { return map.keyframe(id)->solved; };
  for (const ControlPointResidual& residual : controlResiduals(factors, poseOf)) {
    const Vec3 &error = residual.error_m, &sigma = residual.sigma_m;
    text +=
        fmt::format("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f},{}\n", csvField(residual.name),
                    toString(residual.kind), map.keyframe(residual.keyframe)->keyframe.time.nanoseconds(),
                    error.x(), error.y(), error.z(), sigma.x(), sigma.y(), sigma.z(), residual.chi_squared,
                    residual.is_blunder ? "yes" : "no");
  }
  writeOutput(file, text);
}

}  // namespace lodeline
