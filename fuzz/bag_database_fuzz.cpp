#include <sstream>

#include "fuzzed_file.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/bag_listing.h"

// SQLite databases of ROS 2 bags: tables, topics, definitions, and all messages.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".db3");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    std::ostringstream list;
    listMessages(openBagFile(file.path(), &diagnostics).get(), 4, &list);
  });
}
