#include "apps/lodeline/shared/program_file.h"

#include "lodeline/evaluation/trajectory/text_table.h"

namespace lodeline {

uint64_t hashOfBytes(std::string_view bytes) {
  uint64_t hash = 14695981039346656037u;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  return hash;
}

uint64_t programFingerprint() {
  static const uint64_t fingerprint = hashOfBytes(readFileBytes("/proc/self/exe"));
  return fingerprint;
}

}  // namespace lodeline
