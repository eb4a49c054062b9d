#include "lodeline/io/rosbag/bag_kinds.h"

#include "lodeline/io/rosbag/ros1/ros1_bag.h"
#include "lodeline/io/rosbag/ros2/ros2_bag.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {

std::unique_ptr<BagFile> openBagFile(const std::filesystem::path& bag, Diagnostics* diagnostics) {
  const RecognizedFile recognized = recognizeFile(bag);
  const bool is_ros2 = recognized.kind == FileKind::Ros2Bag || recognized.kind == FileKind::Mcap ||
                       recognized.kind == FileKind::Ros2Folder;
  if (is_ros2) return std::make_unique<Ros2Bag>(bag, diagnostics);
  return std::make_unique<Ros1Bag>(bag, diagnostics);
}

}  // namespace lodeline
