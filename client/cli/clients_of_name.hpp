#pragma once

#include <cstdint>
#include <vector>

#include "proto/types/client_use.hpp"

namespace kinship::cli {

/// Clients of one name, added up: each call of a program is a client of its own.
struct ClientsOfName {
  ClientUse use;  ///< `client` is the name
  std::uint64_t clients = 0;
};

/// By the name in the certificate, or by program and host ("kinship-plan on host7"); the
/// participant of a client that says neither. In the order of the first of each.
std::vector<ClientsOfName> by_name(const std::vector<ClientUse>& clients);

}  // namespace kinship::cli
