#include "lodeline/output/files/pose_writer.h"

#include <fmt/ostream.h>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {

PoseWriter::PoseWriter(const std::filesystem::path& file) : file_(file), stream_(openOutput(file)) {
  stream_ << "# timestamp [s] x y z qx qy qz qw\n" << std::flush;
}

void PoseWriter::write(Time time, const Rigid3& world_from_body) {
  const Vec3& p = world_from_body.translation;
  const Quat q = so3::canonical(world_from_body.rotation);
  fmt::print(stream_, "{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", secondsText(time), p.x(),
             p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  stream_.flush();
  if (!stream_) {
    throw InputError(file_.string() + ": writing failed at " + std::to_string(time.nanoseconds()) +
                     " ns; is the disk full?");
  }
}

}  // namespace lodeline
