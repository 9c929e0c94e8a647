#pragma once

#include <iosfwd>

#include "client/cli/admin_rows.hpp"
#include "client/link/client.hpp"

namespace kinship::cli {

/// `status --clients`: who takes how much of a server, most first.
int list_clients(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err);

}  // namespace kinship::cli
