#include "client/cli/clients_of_name.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <string>

namespace kinship::cli {
namespace {

/// "kinship-plan on host7"; the certificate's name, or the participant, of one that does not say.
std::string name_of(const ClientUse& client) {
  if (client.program.empty() && client.host.empty())
    return client.client;
  return (client.program.empty() ? "?" : client.program) +
         (client.host.empty() ? "" : " on " + client.host);
}

void add_to(const ClientUse& one, ClientsOfName& all) {
  ++all.clients;
  ClientUse& use = all.use;
  for (const std::string& label : one.robots)
    if (std::ranges::find(use.robots, label) == use.robots.end())
      use.robots.push_back(label);
  const auto sum = [&](auto... members) { ((use.*members += one.*members), ...); };
  sum(&ClientUse::attempts_per_s, &ClientUse::bytes_per_s, &ClientUse::on_way, &ClientUse::waiting,
      &ClientUse::leases, &ClientUse::fits, &ClientUse::attempts, &ClientUse::registered_robots,
      &ClientUse::created_tasks, &ClientUse::stored_bytes, &ClientUse::refused,
      &ClientUse::requests, &ClientUse::bad_requests);
  if (one.last_seen_ms >= use.last_seen_ms && !one.refused_for.empty())
    use.refused_for = one.refused_for;
  use.last_seen_ms = std::max(use.last_seen_ms, one.last_seen_ms);
}

}  // namespace

std::vector<ClientsOfName> by_name(const std::vector<ClientUse>& clients) {
  std::vector<ClientsOfName> names;
  std::map<std::string, std::size_t> places;
  for (const ClientUse& client : clients) {
    const std::string name = name_of(client);
    const auto [place, is_new] = places.emplace(name, names.size());
    if (is_new)
      names.emplace_back().use.client = name;
    add_to(client, names[place->second]);
  }
  return names;
}

}  // namespace kinship::cli
