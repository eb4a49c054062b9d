#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"

// Replaces bag_writer.cpp in builds without librosbag-storage.

namespace lodeline {

class BagWriter::Implementation {};

BagWriter::BagWriter(const std::filesystem::path&, const std::string&) {
  throw UsageError(
      "this program was built without librosbag-storage and cannot write bags; install librosbag-storage-dev "
      "and "
      "libsensor-msgs-dev and build it again");
}

BagWriter::~BagWriter() = default;

void BagWriter::write(const std::string&, const std::string&, Time, wire::Bytes) {}

void BagWriter::close() {}

}  // namespace lodeline
