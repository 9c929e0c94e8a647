#include "server/app/join.hpp"

#include <spdlog/spdlog.h>

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

/// The holder of a port of a place in the domain, and the port.
struct TakenPlace {
  std::uint16_t port = 0;
  PortHolder holder;
};

std::string explain(const ServerOptions& options, const TakenPlace& taken,
                    const std::optional<ServerStatus>& server) {
  const std::string start = "domain " + std::to_string(options.domain) + ": ";
  if (!server && taken.holder.program != kProgram)
    return start + "UDP port " + std::to_string(taken.port) + " is taken by " +
           describe(taken.holder) + ", no kinshipd answers there, and the next " +
           std::to_string(dds::kServerPlaces - 1) + " places are taken too; " + advise(taken.port);
  std::string message =
      start + "another kinshipd has it, at UDP port " + std::to_string(taken.port);
  if (taken.holder.process != 0)
    message += ", process " + std::to_string(taken.holder.process);
  if (server && !server->store_file.empty())
    message += ", store '" + server->store_file + "'";
  if (!server)
    message += ", but does not answer";
  return message + "; end that one, or take another domain (--domain N)";
}

std::optional<TakenPlace> find_taken(std::uint32_t domain, std::uint32_t place) {
  for (const std::uint16_t port : dds::server_ports(domain, place))
    if (auto holder = find_port_holder(port))
      return TakenPlace{port, *std::move(holder)};
  return std::nullopt;
}

/// The first place of the domain that is free. Others hold those before it, e.g. ROS nodes; where a
/// kinshipd does, it has the domain, whichever place is free.
/// \throws Failure(Unavailable) then, and if none is free.
std::uint32_t choose_place(const ServerOptions& options, const std::string& address) {
  std::optional<std::uint32_t> place;
  std::optional<TakenPlace> taken;
  for (std::uint32_t each = 0; each < dds::kServerPlaces; ++each) {
    auto holder = find_taken(options.domain, each);
    if (!holder && !place)
      place = each;
    if (holder && (!taken || holder->holder.program == kProgram))
      taken = std::move(holder);
  }
  if (!taken)
    return 0;
  const auto server = ask_server(options, address);
  if (!place || server || taken->holder.program == kProgram)
    throw Failure(ErrorCode::Unavailable, explain(options, *taken, server));
  if (!options.security.empty() && taken->holder.process == 0)  // it would not have answered
    throw Failure(ErrorCode::Unavailable,
                  "domain " + std::to_string(options.domain) + ": UDP port " +
                      std::to_string(taken->port) +
                      " is taken by another user's process, which may be a secured kinshipd; end "
                      "that one, or take another domain (--domain N)");
  spdlog::info("domain {}: {} has UDP port {}; takes place {}, port {}", options.domain,
               describe(taken->holder), taken->port, *place,
               dds::discovery_port(options.domain, *place));
  return *place;
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
  dds::ParticipantOptions participant = participant_options(options, clients);
  const std::string address =
      address_of(options.network_interface.empty() ? "lo" : options.network_interface);
  // CYCLONEDDS_URI may name other ports.
  if (!address.empty() && !std::getenv("CYCLONEDDS_URI"))
    participant.place = choose_place(options, address);
  return dds::Participant(participant);
}

}  // namespace kinship::app
