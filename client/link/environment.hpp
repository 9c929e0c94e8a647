#pragma once

#include "client/link/client.hpp"

namespace kinship::link {

/// What the environment says of the server: KINSHIP_DOMAIN, 0 to 230, and KINSHIP_SERVER, its host.
/// What it does not say is as ClientOptions has it. \throws Failure(InvalidInput) for a domain that
/// is none.
ClientOptions options_from_environment();

}  // namespace kinship::link
