#include "lodeline/trajectory.h"

#include <fmt/format.h>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {

void writeTum(const Trajectory& trajectory, const std::filesystem::path& file) {
  std::string text = "# timestamp [s] x y z qx qy qz qw\n";
  for (const StampedPose& pose : trajectory.poses) {
    const Vec3& p = pose.world_from_body.translation;
    const Quat q = so3::canonical(pose.world_from_body.rotation);
    text += fmt::format("{} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", secondsText(pose.time),
                        p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  writeOutput(file, text);
}

}  // namespace lodeline
