#pragma once

#include <string>

namespace kinship::link {

/// Why no address is known for a host, as the name service's message: "Name or service not known";
/// empty if there is one. Loopback addresses and "localhost" are not looked up.
std::string why_unknown(const std::string& host);

/// Whether a host is this machine: a loopback address, "localhost", or this machine's name.
bool is_this_machine(const std::string& host);

}  // namespace kinship::link
