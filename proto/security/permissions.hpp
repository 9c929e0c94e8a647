#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/security/certificate.hpp"
#include "proto/types/caller.hpp"

namespace kinship::security {

/// The subject of a certificate as DDS Security compares it: "CN=NAME,O=Kinship".
std::string subject_text(std::string_view name);

/// The partition of a client, in which it sends and is answered: "client_NAME".
std::string client_partition(std::string_view name);

/// Conversations in which a role has a part: "register", "report", "fetch", "admin".
std::vector<std::string> conversations_of(AccessRole role);

/// What the client may send and read, as a permissions document of DDS Security 1.1, unsigned: the
/// topics that its role needs, in its partition only. The rest is denied.
///
/// Tasks and robots that it is narrowed to are not in it: everybody on the network can read it.
std::string client_permissions(std::string_view name, AccessRole role, const Validity& validity);

/// What the server `name` may: the other side of all of it, in the partitions of all clients.
std::string server_permissions(std::string_view name, const Validity& validity);

}  // namespace kinship::security
