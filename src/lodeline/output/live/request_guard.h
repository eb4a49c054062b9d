#pragma once

#include <string>

namespace lodeline {

/// Whether the `Host` of a request (with or without a port) is an IP address, `localhost` or the name to
/// which the server is bound. A page of another site that lets its own name point to this machine (DNS
/// rebinding) sends that name instead.
bool isAddressOrLocalhost(const std::string& host, const std::string& bound_address);

}  // namespace lodeline
