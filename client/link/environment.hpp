#pragma once

#include "client/link/client.hpp"

namespace kinship::link {

/// KINSHIP_SECURITY: folder of credentials; empty: none.
std::filesystem::path security_from_environment();

/// What the environment says of the server: KINSHIP_DOMAIN, 0 to 230, KINSHIP_SERVER, its host, and
/// KINSHIP_SECURITY. What it does not say is as ClientOptions has it. \throws Failure(InvalidInput)
/// for a domain that is none.
ClientOptions options_from_environment();

}  // namespace kinship::link
