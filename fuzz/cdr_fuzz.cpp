#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include "lodeline/io/rosbag/definitions/definition_parser.h"
#include "lodeline/io/rosbag/definitions/message_conversion.h"
#include "lodeline/io/rosbag/definitions/message_text.h"
#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"

// A definition of a message, a zero byte, and a message. The message is printed as the definition says, and
// converted as a scan of a sonar, as pings of DVLs and as currents.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  using namespace lodeline::definitions;
  const std::span<const uint8_t> input(data, size);
  const auto zero = std::find(input.begin(), input.end(), uint8_t{0});
  if (zero == input.end()) return 0;
  const auto length = static_cast<size_t>(zero - input.begin());
  const std::string_view text(reinterpret_cast<const char*>(data), length);
  const std::span<const uint8_t> message = input.subspan(length + 1);
  for (const Serialization serialization : {Serialization::Cdr, Serialization::Ros1}) {
    try {
      const TypeDescription type = parseDefinition("t/T", text, serialization);
      messageText(message, type, serialization, 4);
      const MessageConversion same({type, serialization}, {type, Serialization::Cdr});
      same.convert(message);
    } catch (const DefinitionError&) {
    } catch (const wire::Reader::CutOff&) {
    }
  }
  for (const std::string type : {"sensor_msgs/LaserScan", "dvl_msgs/DVL", "marine_acoustic_msgs/Dvl",
                                 "uuv_sensor_ros_plugins_msgs/DVL", "sensor_msgs/JointState"}) {
    try {
      const MessageConversion conversion(knownForm(type, Serialization::Cdr),
                                         knownForm(type, Serialization::Ros1));
      const wire::Bytes ros1 = conversion.convert(message);
      if (type.ends_with("/DVL") || type.ends_with("/Dvl"))
        withoutSentinels(messages::parseDvl(type, ros1).ping);
      if (type.ends_with("/JointState")) messages::parseCurrents(type, ros1);
    } catch (const DefinitionError&) {
    } catch (const wire::Reader::CutOff&) {
    }
  }
  return 0;
}
