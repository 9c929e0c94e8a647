#include "server/store/postgres/rows/fit_lease_rows.hpp"

#include <array>

namespace kinship::store::postgres {
namespace {

/// One statement whose commit waits for nothing.
Rows write_lightly(Connection& connection, const Request& request) {
  const std::array<Request, 4> all{Request{"BEGIN"}, Request{"SET LOCAL synchronous_commit = off"},
                                   request, Request{"COMMIT"}};
  std::vector<Rows> rows = connection.query_all(all);
  return std::move(rows[2]);
}

}  // namespace

void note_alive(Connection& connection, const Uuid& server) {
  write_lightly(connection,
                {"INSERT INTO server (run, alive_until, name)"
                 " VALUES ($1, now() + interval '6 s', coalesce(inet_client_addr()::text, 'local'))"
                 " ON CONFLICT (run) DO UPDATE SET alive_until = excluded.alive_until",
                 Parameters(Bytes(server.bytes))});
  write_lightly(connection, {"DELETE FROM server WHERE alive_until < now() - interval '1 day'"});
}

void note_gone(Connection& connection, const Uuid& server) {
  write_lightly(connection, {"DELETE FROM server WHERE run = $1", Parameters(Bytes(server.bytes))});
}

std::optional<FitRight> take_fit_right(Connection& connection, const Digest& id,
                                       const Uuid& server) {
  const Rows taken = write_lightly(
      connection,
      {"INSERT INTO fit_lease AS lease (digest, fence, holder) VALUES ($1, 1, $2)"
       " ON CONFLICT (digest) DO UPDATE SET fence = lease.fence + 1, holder = excluded.holder"
       " WHERE lease.holder = excluded.holder OR NOT EXISTS"
       " (SELECT FROM server WHERE run = lease.holder AND alive_until > now())"
       " RETURNING fence",
       Parameters(Bytes(id.bytes), Bytes(server.bytes))});
  if (taken.empty())
    return std::nullopt;
  return FitRight{static_cast<std::uint64_t>(taken.front().column_integer(0))};
}

void give_back_fit_right(Connection& connection, const Digest& id, const FitRight& right) {
  write_lightly(connection,
                {"UPDATE fit_lease SET holder = ''::bytea WHERE digest = $1 AND fence = $2",
                 Parameters(Bytes(id.bytes), static_cast<std::int64_t>(right.fence))});
}

bool has_fit_right(Connection& connection, const Digest& id, const FitRight& right) {
  return !connection
              .query("SELECT FROM fit_lease WHERE digest = $1 AND fence = $2 FOR SHARE",
                     Bytes(id.bytes), static_cast<std::int64_t>(right.fence))
              .empty();
}

}  // namespace kinship::store::postgres
