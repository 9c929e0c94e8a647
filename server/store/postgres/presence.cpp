#include "server/store/postgres/presence.hpp"

#include <algorithm>
#include <exception>
#include <string>

#include "proto/types/failure.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/postgres/rows/fit_lease_rows.hpp"
#include "server/store/values/codes.hpp"

namespace kinship::store::postgres {
namespace {

std::vector<Digest> digests(Connection& connection, std::string_view sql, std::string_view cursor) {
  std::vector<Digest> digests;
  for (const Row row : connection.query(sql, cursor))
    digests.push_back(id_of<Digest>(row.column_blob(0)));
  return digests;
}

std::vector<ChangedExperience> changed_experience(Connection& connection, std::string_view cursor) {
  std::vector<ChangedExperience> changed;
  for (const Row row : connection.query(
           "SELECT task.name, robot.digest, paths, generation, retired_generation, dropped"
           " FROM experience JOIN task ON task.id = task_id JOIN robot ON robot.id = robot_id"
           " WHERE experience.changed_in >= $1::text::xid8",
           cursor))
    changed.push_back({std::string(row.column_text(0)),
                       {.robot = id_of<Digest>(row.column_blob(1)),
                        .paths = static_cast<std::uint64_t>(row.column_integer(2)),
                        .generation = static_cast<std::uint64_t>(row.column_integer(3)),
                        .retired_generation = static_cast<std::uint64_t>(row.column_integer(4)),
                        .dropped = static_cast<std::uint64_t>(row.column_integer(5))}});
  return changed;
}

bool is_number(std::string_view text) {
  return !text.empty() &&
         std::ranges::all_of(text, [](char letter) { return letter >= '0' && letter <= '9'; });
}

/// The transaction to look from. Numbers of another primary may name transactions that this one
/// never had: then everything is reported.
std::string transaction_of(std::string_view cursor, std::string_view timeline) {
  const std::size_t point = std::min(cursor.find('.'), cursor.size());
  const std::string_view transaction = cursor.substr(std::min(point + 1, cursor.size()));
  if (!is_number(cursor.substr(0, point)) || !is_number(transaction))
    throw Failure(ErrorCode::InvalidInput, "cursor of another listing");
  return cursor.substr(0, point) == timeline ? std::string(transaction) : "0";
}

/// Changes committed since the last look; see Store::changes_since(). The cursor is a transaction
/// id below which no transaction was under way then. Reads one state of the database: in a
/// snapshot. \throws Failure(InvalidInput) for a cursor that is none.
StoreChanges changes_since(Connection& connection, std::string_view cursor) {
  const std::string timeline = std::to_string(timeline_of(connection));
  StoreChanges changes;
  changes.cursor =
      timeline + '.' +
      std::string(connection.query("SELECT pg_snapshot_xmin(pg_current_snapshot())::text")
                      .front()
                      .column_text(0));
  if (cursor.empty())
    return changes;
  const std::string since = transaction_of(cursor, timeline);
  changes.experience = changed_experience(connection, since);
  changes.robots =
      digests(connection,
              "SELECT digest FROM robot WHERE changed_in >= $1::text::xid8"
              " UNION SELECT digest FROM gone_robot WHERE changed_in >= $1::text::xid8",
              since);
  changes.evicted =
      digests(connection,
              "SELECT digest FROM evicted_distribution WHERE evicted_in >= $1::text::xid8", since);
  for (const Row row :
       connection.query("SELECT name FROM former_task WHERE changed_in >= $1::text::xid8", since))
    changes.former_tasks.emplace_back(row.column_text(0));
  return changes;
}

}  // namespace

Presence::~Presence() {
  try {
    pool_.use([&](Connection& connection) { postgres::note_gone(connection, server_); });
  } catch (const std::exception&) {  // then it is dead a few seconds later
  }
}

StoreChanges Presence::changes_since(std::string_view cursor) {
  note_alive();
  return pool_.read_snapshot(
      [&](Connection& connection) { return postgres::changes_since(connection, cursor); });
}

void Presence::note_alive() {
  constexpr std::chrono::seconds kInterval{1};
  const auto now = std::chrono::steady_clock::now();
  {
    const std::lock_guard lock(mutex_);
    if (now - noted_ < kInterval)
      return;
    noted_ = now;
  }
  pool_.use([&](Connection& connection) { postgres::note_alive(connection, server_); });
}

std::optional<FitRight> Presence::take_fit_right(const Digest& id) {
  note_alive();  // before others are to believe in it
  return pool_.use(
      [&](Connection& connection) { return postgres::take_fit_right(connection, id, server_); });
}

void Presence::give_back_fit_right(const Digest& id, const FitRight& right) noexcept {
  try {
    pool_.use(
        [&](Connection& connection) { postgres::give_back_fit_right(connection, id, right); });
  } catch (const std::exception&) {  // free once this server takes it again, or ends
  }
}

}  // namespace kinship::store::postgres
