#pragma once

#include <string>
#include <vector>

namespace kinship::dds {

/// One network interface of this machine.
struct NetworkInterface {
  std::string name;                    ///< e.g. eth0
  std::vector<std::string> addresses;  ///< IPv4, dotted; empty if it has none
  bool is_up = false;
};

/// All network interfaces, in the system's order; empty if the system does not list them.
std::vector<NetworkInterface> network_interfaces();

/// Why the conversations cannot use the interface of this name (it does not exist, is down, or has
/// no IPv4 address), and a remedy. Empty if they can, or if `interfaces` is empty.
std::string explain_unusable(const std::string& name,
                             const std::vector<NetworkInterface>& interfaces);

}  // namespace kinship::dds
