#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/security/certificate.hpp"
#include "proto/types/caller.hpp"

namespace kinship::security {

/// The subject of a certificate as DDS Security compares it: "CN=NAME,O=Kinship".
std::string subject_text(std::string_view name);

/// The partition of a client, for its requests and replies: "client_NAME".
std::string client_partition(std::string_view name);

/// Conversations that a role may use: "register", "report", "fetch", "admin".
std::vector<std::string> conversations_of(AccessRole role);

/// The permissions of a client as a document of DDS Security 1.1, unsigned: to write and read the
/// topics of its role, in its partition only. The rest is denied.
///
/// The tasks and robots that it is limited to are not included: the document is readable on the
/// network.
std::string client_permissions(std::string_view name, AccessRole role, const Validity& validity);

/// The permissions of the server `name`: the other side of all topics, in the partitions of all
/// clients.
std::string server_permissions(std::string_view name, const Validity& validity);

}  // namespace kinship::security
