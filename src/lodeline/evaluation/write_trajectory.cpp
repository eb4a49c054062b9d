#include "lodeline/evaluation/write_trajectory.h"

#include <fmt/format.h>

#include "lodeline/base/output_file.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

void writeTum(const Trajectory& trajectory, const std::filesystem::path& file) {
  std::string text = "# timestamp [s] x y z qx qy qz qw\n";
  for (const StampedPose& pose : trajectory.poses) {
    const int64_t ns = pose.time.nanoseconds();
    const Vec3& p = pose.world_from_body.translation;
    const Quat q = so3::canonical(pose.world_from_body.rotation);
    text += fmt::format("{}.{:09} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", ns / 1000000000,
                        ns % 1000000000, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  writeOutput(file, text);
}

}  // namespace lodeline
