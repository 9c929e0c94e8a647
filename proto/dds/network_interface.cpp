#include "proto/dds/network_interface.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>
#include <memory>

namespace kinship::dds {
namespace {

std::string ipv4_of(const ifaddrs& entry) {
  if (!entry.ifa_addr || entry.ifa_addr->sa_family != AF_INET)
    return {};
  sockaddr_in address{};
  std::memcpy(&address, entry.ifa_addr, sizeof address);
  char text[INET_ADDRSTRLEN] = {};
  const char* const written = inet_ntop(AF_INET, &address.sin_addr, text, sizeof text);
  return written ? written : "";
}

std::string list(const std::vector<NetworkInterface>& interfaces) {
  std::string text;
  for (const NetworkInterface& each : interfaces) {
    if (!each.is_up || each.addresses.empty())
      continue;
    text += (text.empty() ? "" : ", ") + each.name + " (" + each.addresses.front() + ")";
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::vector<NetworkInterface> network_interfaces() {
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0)
    return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, &freeifaddrs);
  std::vector<NetworkInterface> interfaces;
  for (const ifaddrs* entry = all; entry; entry = entry->ifa_next) {
    const auto has_name = [entry](const auto& each) { return each.name == entry->ifa_name; };
    auto place = std::find_if(interfaces.begin(), interfaces.end(), has_name);
    if (place == interfaces.end())
      place = interfaces.insert(interfaces.end(), {entry->ifa_name, {}, false});
    place->is_up = (entry->ifa_flags & IFF_UP) != 0;
    if (std::string address = ipv4_of(*entry); !address.empty())
      place->addresses.push_back(std::move(address));
  }
  return interfaces;
}

std::string explain_unusable(const std::string& name,
                             const std::vector<NetworkInterface>& interfaces) {
  if (interfaces.empty())
    return {};
  const std::string start = "network interface '" + name + "' ";
  const auto has_name = [&name](const auto& each) { return each.name == name; };
  const auto place = std::find_if(interfaces.begin(), interfaces.end(), has_name);
  if (place == interfaces.end()) {
    const auto has_address = [&name](const NetworkInterface& each) {
      return std::find(each.addresses.begin(), each.addresses.end(), name) != each.addresses.end();
    };
    const auto meant = std::find_if(interfaces.begin(), interfaces.end(), has_address);
    if (meant != interfaces.end())
      return start + "is an address, that of the interface '" + meant->name + "'; name that";
    return start + "does not exist; those that can be used: " + list(interfaces);
  }
  if (!place->is_up)
    return start + "is down; switch it on ('ip link set " + name +
           " up'), or take one that is up: " + list(interfaces);
  if (place->addresses.empty())
    return start + "has no IPv4 address; give it one, or take one that has: " + list(interfaces);
  return {};
}

}  // namespace kinship::dds
