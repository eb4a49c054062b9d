#pragma once

#include <string>

namespace lodeline {

/// Whether the `Host` of a request (name or address, with or without a port) is an IP address, `localhost` or
/// the name that the server is bound to. A page of another site that points its own name at this machine
/// (DNS rebinding) sends that name instead.
bool isAddressOrLocalhost(const std::string& host, const std::string& bound_address);

}  // namespace lodeline
