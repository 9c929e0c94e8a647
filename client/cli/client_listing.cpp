#include "client/cli/client_listing.hpp"

#include <string>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/tables/table.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

constexpr const char* kStatusClients = "status --clients";

std::string labels_text(const std::vector<std::string>& labels) {
  std::string text;
  for (const std::string& label : labels)
    text += (text.empty() ? "" : ", ") + label;
  return text.empty() ? "-" : text;
}

/// "12, last for bytes".
std::string refused_text(const ClientUse& client) {
  const std::string count = std::to_string(client.refused);
  return client.refused_for.empty() ? count : count + ", last for " + client.refused_for;
}

std::vector<std::string> cells_of(const ClientUse& client, std::int64_t now) {
  return {client.client,
          labels_text(client.robots),
          number_text(client.attempts_per_s, 1),
          size_text(static_cast<std::uint64_t>(client.bytes_per_s)),
          std::to_string(client.on_way + client.waiting),
          std::to_string(client.leases),
          std::to_string(client.fits),
          refused_text(client),
          age_text(client.last_seen_ms, now),
          std::to_string(client.attempts),
          std::to_string(client.registered_robots),
          std::to_string(client.created_tasks),
          size_text(client.stored_bytes)};
}

}  // namespace

int list_clients(link::Client& server, const ListOptions& options, std::ostream& out,
                 std::ostream& err) {
  if (options.json)
    return print_rows_as_json(server, AdminVerb::ListClients, options, kStatusClients, out, err);
  Table table({"CLIENT",
               {"ROBOTS", Fit::Cut},
               "ATTEMPTS/S",
               "BYTES/S",
               "WAITING",
               "LEASES",
               "FITS",
               "REFUSED",
               "SEEN",
               {"ATTEMPTS", Fit::Wide},
               {"NEW ROBOTS", Fit::Wide},
               {"NEW TASKS", Fit::Wide},
               {"STORED", Fit::Wide}});
  int broken = kDone;
  const int code = for_each_row(server, AdminVerb::ListClients, options, kStatusClients, err,
                                [&](const std::string& row) {
                                  const Result<ClientUse> client = json::client_use_from_json(row);
                                  if (!client) {
                                    broken = refuse(kStatusClients, client.error(), err);
                                    return false;
                                  }
                                  table.add_row(cells_of(*client, now_ms()));
                                  return true;
                                });
  if (code == kDone && broken == kDone)
    table.print(out);
  return code == kDone ? broken : code;
}

}  // namespace kinship::cli
