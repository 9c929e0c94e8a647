#include "server/app/join.hpp"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "proto/codec/conversation.hpp"
#include "proto/dds/network_interface.hpp"
#include "proto/dds/requester.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/security/security_folder.hpp"
#include "proto/types/failure.hpp"
#include "server/app/port_holder.hpp"

namespace kinship::app {
namespace {

constexpr const char* kProgram = "kinshipd";
/// A server answers within some tens of milliseconds; on a busy machine it may take longer.
constexpr std::chrono::seconds kPatience{3};

/// IPv4 address of a network interface; empty if it has none, or does not exist.
std::string address_of(const std::string& network_interface) {
  for (const dds::NetworkInterface& each : dds::network_interfaces())
    if (each.name == network_interface && !each.addresses.empty())
      return each.addresses.front();
  return {};
}

/// The status of the kinshipd of this domain; nothing if none answers.
std::optional<ServerStatus> ask_server(const ServerOptions& options, const std::string& address) {
  try {
    const dds::Participant participant({.domain = options.domain,
                                        .role = dds::Role::Client,
                                        .server = address,
                                        .network_interface = options.network_interface});
    dds::Requester<codec::AdminConversation> requester(participant, Uuid::random());
    const AdminRequest status;
    const auto reply = requester.call(status, std::chrono::steady_clock::now() + kPatience);
    if (!reply)
      return std::nullopt;
    const auto answer =
        json::row_from_json<ServerStatus>(reply->rows.empty() ? "" : reply->rows.front());
    return answer ? *answer : ServerStatus{};
  } catch (const Failure&) {
    return std::nullopt;
  }
}

std::string describe(const PortHolder& holder) {
  if (holder.process == 0)
    return "a process of user " + std::to_string(holder.user) + " (socket " +
           std::to_string(holder.inode) + " in /proc/net/udp)";
  return "'" + holder.program + "' (process " + std::to_string(holder.process) + ")";
}

/// Which domains to take instead: below the ports that the system hands out, if this one's are
/// among them.
std::string advise(std::uint16_t port) {
  std::ifstream stream("/proc/sys/net/ipv4/ip_local_port_range");
  std::uint32_t first = 0, last = 0;
  const std::uint32_t first_data_port = dds::discovery_port(0) + 1U;
  if (!(stream >> first >> last) || port < first || port > last || first <= first_data_port)
    return "take another domain (--domain N)";
  const std::uint32_t ports_per_domain = dds::discovery_port(1) - dds::discovery_port(0);
  return "the system gives ports from " + std::to_string(first) + " to " + std::to_string(last) +
         " to whoever asks for any, take a domain from 0 to " +
         std::to_string((first - 1 - first_data_port) / ports_per_domain) + " (--domain N)";
}

std::string explain(const ServerOptions& options, std::uint16_t port, const PortHolder& holder,
                    const std::string& address) {
  const std::string start = "domain " + std::to_string(options.domain) + ": ";
  const auto server = ask_server(options, address);
  if (!server && holder.program != kProgram)
    return start + "UDP port " + std::to_string(port) + " is taken by " + describe(holder) +
           ", no kinshipd answers there; " + advise(port);
  std::string message = start + "another kinshipd has it, at UDP port " + std::to_string(port);
  if (holder.process != 0)
    message += ", process " + std::to_string(holder.process);
  if (server && !server->store_file.empty())
    message += ", store '" + server->store_file + "'";
  if (!server)
    message += ", but does not answer";
  return message + "; end that one, or take another domain (--domain N)";
}

dds::ParticipantOptions participant_options(
    const ServerOptions& options, const std::shared_ptr<const security::ClientDirectory>& clients) {
  dds::ParticipantOptions participant{.domain = options.domain,
                                      .role = dds::Role::Server,
                                      .network_interface = options.network_interface};
  if (clients) {
    participant.security = security::SecurityFolder(options.security).server_credentials();
    participant.directory = [clients](const std::string& name) {
      return clients->caller(
          name, std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
    };
  }
  return participant;
}

}  // namespace

dds::Participant join_domain(const ServerOptions& options,
                             const std::shared_ptr<const security::ClientDirectory>& clients) {
  try {
    return dds::Participant(participant_options(options, clients));
  } catch (const Failure& failure) {
    const std::string address =
        address_of(options.network_interface.empty() ? "lo" : options.network_interface);
    // CYCLONEDDS_URI may name other ports.
    if (failure.code() != ErrorCode::Unavailable || address.empty() ||
        std::getenv("CYCLONEDDS_URI"))
      throw;
    for (const std::uint16_t port : dds::server_ports(options.domain))
      if (const auto holder = find_port_holder(port))
        throw Failure(ErrorCode::Unavailable, explain(options, port, *holder, address));
    throw;
  }
}

}  // namespace kinship::app
