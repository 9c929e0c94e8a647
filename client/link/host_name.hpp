#pragma once

#include <string>

namespace kinship::link {

/// Why no address is known for a host, in the words of the name service: "Name or service not
/// known"; empty if there is one. Asks nobody about addresses and "localhost".
std::string why_unknown(const std::string& host);

/// Whether a host is this machine: a loopback address, "localhost", or this machine's name.
bool is_this_machine(const std::string& host);

}  // namespace kinship::link
