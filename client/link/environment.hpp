#pragma once

#include "client/link/client.hpp"

namespace kinship::link {

/// KINSHIP_SECURITY: folder of credentials; empty: none.
std::filesystem::path security_from_environment();

/// KINSHIP_TOKEN: file with a server's token; empty: none.
std::filesystem::path token_from_environment();

/// KINSHIP_DOMAIN; the default of ClientOptions without it. \throws Failure(InvalidInput).
std::uint32_t domain_from_environment();

/// KINSHIP_SERVER; likewise.
std::string server_from_environment();

/// KINSHIP_TIMEOUT; likewise.
std::chrono::milliseconds timeout_from_environment();

/// Options from the environment: KINSHIP_DOMAIN, 0 to 230, KINSHIP_SERVER, the server's host,
/// KINSHIP_TIMEOUT, 0.01 to 86 400 s, and KINSHIP_SECURITY. A missing variable leaves the default
/// of ClientOptions. \throws Failure(InvalidInput) for an invalid domain or timeout.
ClientOptions options_from_environment();

}  // namespace kinship::link
