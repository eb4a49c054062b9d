#include "lodeline/io/synchronizer/frame_packet.h"

#include <algorithm>
#include <iterator>

namespace lodeline {
namespace {

template <typename Reading>
void putBefore(std::vector<Reading> before, std::vector<Reading>* readings) {
  before.insert(before.end(), std::make_move_iterator(readings->begin()),
                std::make_move_iterator(readings->end()));
  *readings = std::move(before);
}

}  // namespace

void FramePacket::prepend(FramePacket before) {
  // Both packets have the reading at their common border.
  if (!before.imu.empty() && !imu.empty() && before.imu.back().time == imu.front().time)
    before.imu.pop_back();
  putBefore(std::move(before.imu), &imu);
  readings.prepend(std::move(before.readings));
  longest_imu_gap_s = std::max(longest_imu_gap_s, before.longest_imu_gap_s);
}

}  // namespace lodeline
