#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/ros1_writer.h"

// Replaces ros1_writer.cpp in builds without librosbag-storage.

namespace lodeline {

class Ros1Writer::Implementation {};

Ros1Writer::Ros1Writer(const std::filesystem::path&, const std::string&) {
  throw UsageError(
      "this program was built without librosbag-storage and cannot write bags of ROS 1; install "
      "librosbag-storage-dev and libsensor-msgs-dev and build it again");
}

Ros1Writer::~Ros1Writer() = default;

void Ros1Writer::write(const std::string&, const std::string&, Time, wire::Bytes) {}

bool Ros1Writer::takesStored(const BagConnection&) const { return false; }

void Ros1Writer::writeStored(const BagConnection&, Time, wire::Bytes) {}

void Ros1Writer::close() {}

}  // namespace lodeline
