#include <algorithm>
#include <string>
#include <string_view>

#include "proto/dds/participant.hpp"
#include "proto/types/failure.hpp"

namespace kinship::dds {
namespace {

bool is_host_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '-' || c == '_' || c == ':';
}

/// Text that goes into the XML.
const std::string& checked(std::string_view what, const std::string& name) {
  if (name.size() > 253 || !std::all_of(name.begin(), name.end(), is_host_character))
    throw Failure(ErrorCode::InvalidInput, std::string(what) + " '" + name + "': no such name");
  return name;
}

constexpr const char* kLoopback = "lo";

bool is_loopback(const std::string& host) {
  return host.starts_with("127.") || host == "localhost";
}

std::string interfaces(const ParticipantOptions& options) {
  const std::string name = chosen_interface(options);
  if (name.empty())
    return {};
  const bool has_multicast = options.role == Role::RosNode && name != kLoopback;
  return "<Interfaces><NetworkInterface name=\"" + name +
         (has_multicast ? "\"" : "\" multicast=\"false\"") + "/></Interfaces>";
}

std::string discovery(const ParticipantOptions& options) {
  if (options.role == Role::Server)
    return "<ParticipantIndex>" + std::to_string(options.place) + "</ParticipantIndex>";
  if (options.server.empty())
    throw Failure(ErrorCode::InvalidInput, "host of the server: is empty");
  std::string peers;
  for (std::uint32_t place = 0; place < kServerPlaces; ++place)
    peers += "<Peer address=\"" + checked("host of the server", options.server) + ":" +
             std::to_string(discovery_port(options.domain, place)) + "\"/>";
  return "<ParticipantIndex>none</ParticipantIndex><Peers>" + peers + "</Peers>";
}

/// As a ROS 2 node: the next participant index that is free, other nodes by multicast, or on
/// loopback, which has none, by asking at the indices of this machine. The domain's number in this
/// process is another one: it may have that domain as a server, too.
std::string node_configuration(const ParticipantOptions& options) {
  const bool is_local = chosen_interface(options) == kLoopback;
  return "<CycloneDDS xmlns=\"https://cdds.io/config\"><Domain Id=\"any\"><General>" +
         interfaces(options) + "<AllowMulticast>" + (is_local ? "false" : "default") +
         "</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>"
         "<FragmentSize>8000B</FragmentSize></General><Discovery><ExternalDomainId>" +
         std::to_string(options.domain) +
         "</ExternalDomainId><ParticipantIndex>auto</ParticipantIndex>"
         "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>" +
         (is_local ? "<Peers><Peer address=\"127.0.0.1\"/></Peers>" : "") +
         "<SPDPInterval>3s</SPDPInterval><LeaseDuration>10s</LeaseDuration></Discovery><Internal>"
         "<SocketReceiveBufferSize max=\"4MB\"/><Watermarks><WhcHigh>8MB</WhcHigh></Watermarks>"
         "<MaxSampleSize>12MB</MaxSampleSize></Internal></Domain></CycloneDDS>";
}

}  // namespace

std::string chosen_interface(const ParticipantOptions& options) {
  const std::string& name = checked("network interface", options.network_interface);
  if (name.empty() && (options.role != Role::Client || is_loopback(options.server)))
    return kLoopback;
  return name;
}

std::uint16_t discovery_port(std::uint32_t domain, std::uint32_t place) {
  if (domain > kMaxDomain)
    throw Failure(ErrorCode::InvalidInput,
                  "domain " + std::to_string(domain) + " exceeds " + std::to_string(kMaxDomain));
  return static_cast<std::uint16_t>(7400 + 250 * domain + 10 + 2 * place);
}

std::array<std::uint16_t, 2> server_ports(std::uint32_t domain, std::uint32_t place) {
  const std::uint16_t discovery = discovery_port(domain, place);
  return {discovery, static_cast<std::uint16_t>(discovery + 1)};
}

std::string cyclone_configuration(const ParticipantOptions& options) {
  discovery_port(options.domain);  // checks the domain
  if (options.role == Role::RosNode)
    return node_configuration(options);
  return "<CycloneDDS xmlns=\"https://cdds.io/config\"><Domain Id=\"any\"><General>" +
         interfaces(options) +
         "<AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>"
         "<FragmentSize>8000B</FragmentSize></General><Discovery>" +
         discovery(options) + "<SPDPInterval>1s</SPDPInterval><LeaseDuration>" +
         std::to_string(kLease.count()) +
         "s</LeaseDuration></Discovery><Internal>"
         "<SocketReceiveBufferSize max=\"4MB\"/><Watermarks><WhcHigh>8MB</WhcHigh></Watermarks>"
         "<HeartbeatInterval>10ms</HeartbeatInterval><NackDelay>10ms</NackDelay>"
         "<MaxSampleSize>2MB</MaxSampleSize></Internal></Domain></CycloneDDS>";
}

}  // namespace kinship::dds
