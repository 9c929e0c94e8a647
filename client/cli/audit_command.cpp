#include "client/cli/audit_command.hpp"

#include <optional>
#include <ostream>
#include <vector>

#include "client/cli/admin_rows.hpp"
#include "client/cli/audit_selection.hpp"
#include "client/cli/cell_text.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

constexpr const char* kAudit = "audit";

std::string place_text(const AuditEntry& entry) {
  return entry.is_local ? "this machine" : "another host";
}

std::vector<std::string> audit_cells(const AuditEntry& entry, std::int64_t now) {
  const auto or_none = [](const std::string& text) { return text.empty() ? "-" : text; };
  return {age_text(entry.time_ms, now),
          entry.name.empty() ? place_text(entry) : entry.name,
          entry.verb,
          or_none(entry.target),
          std::string(to_text(entry.outcome)),
          or_none(entry.message.empty() ? entry.after : entry.message),
          or_none(entry.before),
          or_none(entry.role),
          or_none(entry.client),
          place_text(entry),
          time_text(entry.time_ms)};
}

/// Calls `use` with each entry that is wanted. \return an exit code.
template <typename Use>
int for_each_entry(link::Client& server, const AuditOptions& options, std::ostream& err, Use use) {
  AdminRequest request;
  request.verb = AdminVerb::ListAudit;
  request.argument = options.who;
  AuditSelection selection(options.since_ms, options.limit);
  std::string unreadable;
  const auto error = link::for_each_row(
      server, request,
      [&](const std::string& row) {
        const Result<AuditEntry> entry = json::row_from_json<AuditEntry>(row);
        if (!entry)
          unreadable = entry.error().message;
        if (entry && selection.takes(*entry))
          use(*entry, row);
        return entry && !selection.is_full();
      },
      options.since_ms > 0 ? 0 : options.limit);
  if (error)
    return refuse(kAudit, *error, err);
  if (!unreadable.empty())
    return refuse(kAudit, {ErrorCode::Internal, "cannot read the server's row: " + unreadable},
                  err);
  return kDone;
}

}  // namespace

int list_audit(link::Client& server, const AuditOptions& options, std::ostream& out,
               std::ostream& err) {
  Table table({"AGE",
               {"WHO", Fit::Cut},
               "ACT",
               {"TARGET", Fit::Cut},
               "OUTCOME",
               {"WHAT CAME OF IT", Fit::Cut},
               {"BEFORE", Fit::Wide},
               {"ROLE", Fit::Wide},
               {"CLIENT", Fit::Wide},
               {"FROM", Fit::Wide},
               {"WHEN", Fit::Wide}});
  std::string document = "{\"rows\":[";
  bool is_first = true;
  const std::int64_t now = now_ms();
  const int code =
      for_each_entry(server, options, err, [&](const AuditEntry& entry, const std::string& row) {
        if (!options.json)
          return table.add_row(audit_cells(entry, now));
        document += (is_first ? "\n" : ",\n") + row;
        is_first = false;
      });
  if (code != kDone)
    return code;
  if (options.json)
    out << document << "\n]}\n";
  else
    table.print(out);
  return kDone;
}

}  // namespace kinship::cli
