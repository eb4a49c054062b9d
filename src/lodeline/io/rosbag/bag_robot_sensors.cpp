#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"
#include "lodeline/util/angles.h"

// The parts of BagSource that read altimeter, DVL and current sensors.
namespace lodeline {
namespace {

std::string nameOf(const BagFile& bag, const BagTopic& topic) {
  return fmt::format("{} {}", bag.file().string(), topic.connection.topic);
}

}  // namespace

void BagSource::settleRobotSensors() {
  if (rig_.dvl) {
    const std::string name = nameOf(*bag_, *cursorOfKind<DvlSample>().topic);
    dvl_screen_.emplace(name, rig_.dvl->beams_D.size(), diagnostics_);
  }
  if (!rig_.currents) return;
  // The first message decides whether the channels are those of the calibration.
  Cursor cursor = cursorOfKind<CurrentSample>();
  const std::string& type = cursor.topic->connection.type;
  while (const std::optional<wire::Bytes> message = nextMessage(&cursor)) {
    std::string reported_when_read_in_earnest;
    const auto parse = [&](std::span<const uint8_t> bytes) { return messages::parseCurrents(type, bytes); };
    const auto currents = messages::checkedReading(*message, parse, &reported_when_read_in_earnest);
    if (!currents) continue;
    messages::inOrder(nameOf(*bag_, *cursor.topic), *currents, rig_.currents->channels);
    if (rig_.currents->channels.empty()) rig_.currents->channels = messages::channelNames(*currents);
    return;
  }
}

std::optional<AltimeterSample> BagSource::nextAltimeter() {
  Cursor& cursor = cursorOfKind<AltimeterSample>();
  while (const auto echoes = nextReading(&cursor, messages::parseAltimeter)) {
    if (echoes->empty()) continue;
    AltimeterSample sample = echoes->front();
    restamp(cursor, &sample);
    return sample;
  }
  return std::nullopt;
}

void BagSource::checkBeams(const std::vector<Vec3>& stated_D) {
  constexpr double kMost_rad = 2.0 * kDegree;
  if (are_beams_checked_ || stated_D.empty()) return;
  are_beams_checked_ = true;
  const std::optional<double> difference = messages::beamDifference_rad(stated_D, rig_.dvl->beams_D);
  if (!difference || *difference < kMost_rad) return;
  diagnostics_->report(
      Severity::Warning, "dvl_beams",
      fmt::format(
          "{}: its messages state beams that differ from those of the rig by up to {:.1f} degrees; write "
          "their directions as `beams` of dvl0",
          nameOf(*bag_, *cursorOfKind<DvlSample>().topic), *difference * kDegreesPerRadian));
}

std::optional<DvlSample> BagSource::nextDvl() {
  Cursor& cursor = cursorOfKind<DvlSample>();
  if (!dvl_screen_) return std::nullopt;
  const std::string& type = cursor.topic->connection.type;
  auto reading = nextReading(
      &cursor, [&](std::span<const uint8_t> message) { return messages::parseDvl(type, message); });
  if (!reading) {
    dvl_screen_->finish();
    return std::nullopt;
  }
  restamp(cursor, &reading->ping);
  checkBeams(reading->beams_D);
  return dvl_screen_->screened(reading->ping);
}

std::optional<CurrentSample> BagSource::nextCurrents() {
  Cursor& cursor = cursorOfKind<CurrentSample>();
  if (!rig_.currents) return std::nullopt;
  const std::string& type = cursor.topic->connection.type;
  while (const auto currents = nextReading(&cursor, [&](std::span<const uint8_t> message) {
           return messages::parseCurrents(type, message);
         })) {
    try {
      CurrentSample sample = messages::inOrder("the message", *currents, rig_.currents->channels);
      restamp(cursor, &sample);
      return sample;
    } catch (const InputError& error) {
      reportMessage(cursor, error.what());
    }
  }
  return std::nullopt;
}

}  // namespace lodeline
