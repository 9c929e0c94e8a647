#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

struct AuditOptions {
  std::string who;            ///< the name in a certificate; empty: all
  std::int64_t since_ms = 0;  ///< Unix time, UTC; 0: all
  std::size_t limit = 0;      ///< entries in all; 0: every one
  bool json = false;
};

/// `audit`: the requests of each client, also refused ones, the newest first.
int list_audit(link::Client& server, const AuditOptions& options, std::ostream& out,
               std::ostream& err);

}  // namespace kinship::cli
