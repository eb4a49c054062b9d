#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>
#include <string>
#include <vector>

namespace lodeline::dds {

/// A message as the bytes of its CDR, with the header of four bytes that states the byte order.
struct RawSample {
  std::vector<uint8_t> cdr;
};

/// Messages of any type of ROS 2 as bytes. Readers and writers of bags take these bytes apart and put them
/// together, so that no type needs generated code.
class RawType : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit RawType(const std::string& dds_name);

  bool serialize(void* sample, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* sample) override;
  std::function<uint32_t()> getSerializedSizeProvider(void* sample) override;
  void* createData() override;
  void deleteData(void* sample) override;
  bool getKey(void* sample, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override;
};

}  // namespace lodeline::dds
