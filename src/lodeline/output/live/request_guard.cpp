#include "lodeline/output/live/request_guard.h"

#include <arpa/inet.h>
#include <strings.h>

namespace lodeline {
namespace {

/// Host name without the port, and without the brackets of an IPv6 address.
std::string nameOf(const std::string& host) {
  if (host.starts_with('[')) {
    const size_t end = host.find(']');
    return end == std::string::npos ? std::string() : host.substr(1, end - 1);
  }
  return host.substr(0, host.find(':'));
}

}  // namespace

bool isAddressOrLocalhost(const std::string& host, const std::string& bound_address) {
  const std::string name = nameOf(host);
  if (name.empty()) return false;
  if (strcasecmp(name.c_str(), "localhost") == 0 || name == bound_address) return true;
  unsigned char address[sizeof(in6_addr)];
  return inet_pton(AF_INET, name.c_str(), address) == 1 || inet_pton(AF_INET6, name.c_str(), address) == 1;
}

}  // namespace lodeline
