#include "apps/lodeline_dds/transport/raw_type.h"

#include <cstring>

namespace lodeline::dds {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

/// Size of the first buffers; greater messages get greater ones.
constexpr uint32_t kUsualBytes = 1024;

}  // namespace

RawType::RawType(const std::string& dds_name) {
  setName(dds_name.c_str());
  m_typeSize = kUsualBytes;
  m_isGetKeyDefined = false;
  auto_fill_type_object(false);
  auto_fill_type_information(false);
}

bool RawType::serialize(void* sample, SerializedPayload_t* payload) {
  const std::vector<uint8_t>& cdr = static_cast<const RawSample*>(sample)->cdr;
  if (cdr.size() > payload->max_size) return false;
  std::memcpy(payload->data, cdr.data(), cdr.size());
  payload->length = static_cast<uint32_t>(cdr.size());
  payload->encapsulation = CDR_LE;
  return true;
}

bool RawType::deserialize(SerializedPayload_t* payload, void* sample) {
  static_cast<RawSample*>(sample)->cdr.assign(payload->data, payload->data + payload->length);
  return true;
}

std::function<uint32_t()> RawType::getSerializedSizeProvider(void* sample) {
  return [sample] { return static_cast<uint32_t>(static_cast<const RawSample*>(sample)->cdr.size()); };
}

void* RawType::createData() { return new RawSample; }
void RawType::deleteData(void* sample) { delete static_cast<RawSample*>(sample); }
bool RawType::getKey(void*, InstanceHandle_t*, bool) { return false; }

}  // namespace lodeline::dds
