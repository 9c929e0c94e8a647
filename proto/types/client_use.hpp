#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// Use of a server by one client: a row of ListClients. Numbers since the server's start, or since
/// it last forgot this client.
struct ClientUse {
  std::string client;               ///< its name, or, without security, its participant
  std::vector<std::string> robots;  ///< newest labels that it registered; at most 8
  double attempts_per_s = 0;        ///< mean over about the last minute
  double bytes_per_s = 0;           ///< sent and received, likewise
  std::uint64_t on_way = 0;         ///< attempts taken in and not yet answered
  std::uint64_t waiting = 0;        ///< fetches that wait
  std::uint64_t leases = 0;
  std::uint64_t fits = 0;      ///< looked up or fitted because it was first to request them
  std::uint64_t attempts = 0;  ///< admitted
  std::uint64_t registered_robots = 0;  ///< new to the server
  std::uint64_t created_tasks = 0;
  std::uint64_t stored_bytes = 0;  ///< of paths that it reported
  std::uint64_t refused = 0;       ///< requests over a quota
  std::string refused_for = {};    ///< quota of the last refusal; empty: none
  std::int64_t last_seen_ms = 0;
  // What it says of itself, without security; empty: nothing.
  std::string host = {};
  std::string program = {};
  std::uint64_t requests = 0;      ///< in all
  std::uint64_t bad_requests = 0;  ///< of an administrator: not found, or refused by a rule
};

inline constexpr std::size_t kMaxLabelsOfClient = 8;

template <>
inline constexpr std::tuple kFieldsOf<ClientUse>{
    Field{"client", &ClientUse::client, {.limit = kMaxMachineBytes}},
    Field{"robots", &ClientUse::robots, {.limit = kMaxLabelsOfClient}},
    Field{"attempts_per_s", &ClientUse::attempts_per_s, {.min = 0}},
    Field{"bytes_per_s", &ClientUse::bytes_per_s, {.min = 0}},
    Field{"on_way", &ClientUse::on_way},
    Field{"waiting", &ClientUse::waiting},
    Field{"leases", &ClientUse::leases},
    Field{"fits", &ClientUse::fits},
    Field{"attempts", &ClientUse::attempts},
    Field{"registered_robots", &ClientUse::registered_robots},
    Field{"created_tasks", &ClientUse::created_tasks},
    Field{"stored_bytes", &ClientUse::stored_bytes},
    Field{"refused", &ClientUse::refused},
    Field{"refused_for", &ClientUse::refused_for, {.limit = kMaxWordBytes}},
    Field{"last_seen_ms", &ClientUse::last_seen_ms},
    Field{"host", &ClientUse::host, {.limit = kMaxMachineBytes, .may_be_missing = true}},
    Field{"program", &ClientUse::program, {.limit = kMaxWordBytes, .may_be_missing = true}},
    Field{"requests", &ClientUse::requests, {.may_be_missing = true}},
    Field{"bad_requests", &ClientUse::bad_requests, {.may_be_missing = true}}};

}  // namespace kinship
