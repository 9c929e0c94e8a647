#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>

#include "client/cli/session.hpp"
#include "client/link/client.hpp"
#include "proto/types/attempt_filter.hpp"
#include "proto/types/audit.hpp"

/// Commands that list the contents of a server's store. Each prints a table for people, or one
/// document {"rows": [...]} with `json`, and returns an exit code.
namespace kinship::cli {

/// The listings of a noun, e.g. `list`, with --limit, --json and -o, and with --task and --robot
/// where the verb takes filters.
void add_listings(CLI::App& noun, Session& session);

/// `status --clients`: the use of the server, the busiest clients first; those of one program and
/// host are one row, but with `json` each is its own.
/// \param limit  0: all.
int list_clients(link::Client& server, std::size_t limit, bool json, std::ostream& out,
                 std::ostream& err);

struct AttemptListOptions {
  std::string robot, task;  ///< filters; empty: all
  AttemptFilter filter;
  std::size_t limit = 100;  ///< rows in all; 0: every one
  bool json = false;
};

/// `attempts list`: with why they failed, where their search records say so.
int list_attempts(link::Client& server, const AttemptListOptions& options, std::ostream& out,
                  std::ostream& err);

struct AuditOptions {
  std::string who;            ///< the name in a certificate; empty: all
  std::int64_t since_ms = 0;  ///< Unix time, UTC; 0: all
  std::size_t limit = 0;      ///< entries in all; 0: every one
  bool json = false;
};

/// `audit`: the requests of each client, also refused ones, the newest first.
int list_audit(link::Client& server, const AuditOptions& options, std::ostream& out,
               std::ostream& err);

/// Selects the audit entries to show: the newest since a time, at most a number of them. Entries
/// arrive in the order of their making, the newest first; their times may break that order, as
/// after a restored store or a clock set back, so that an old entry does not end the selection.
class AuditSelection {
 public:
  /// \param since_ms  Unix time, UTC; 0: all.
  /// \param limit     0: every one.
  AuditSelection(std::int64_t since_ms, std::size_t limit) : since_ms_(since_ms), limit_(limit) {}

  /// Whether the next entry is shown.
  bool takes(const AuditEntry& entry) noexcept {
    if (is_full() || entry.time_ms < since_ms_)
      return false;
    ++taken_;
    return true;
  }
  /// Whether no further entry is shown.
  bool is_full() const noexcept { return limit_ > 0 && taken_ >= limit_; }

 private:
  const std::int64_t since_ms_;
  const std::size_t limit_;
  std::size_t taken_ = 0;
};

}  // namespace kinship::cli
