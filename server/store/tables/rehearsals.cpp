#include "server/store/tables/rehearsals.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "server/store/values/columns.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/rehearsal_blob.hpp"

namespace kinship::store {
namespace {

/// By their ids, the newest first; from the index alone.
struct RehearsalRows {
  std::vector<std::int64_t> newest;   ///< of each distribution
  std::vector<std::int64_t> earlier;  ///< of the same ones
};

RehearsalRows all_rows(Session& session) {
  RehearsalRows rows;
  std::optional<Digest> last;
  for (const Row& row : session.query("SELECT id, digest FROM rehearsal ORDER BY digest, id")) {
    const auto digest = id_of<Digest>(row.column_blob(1));
    if (last == digest) {
      rows.earlier.push_back(rows.newest.back());
      rows.newest.pop_back();
    }
    rows.newest.push_back(row.column_integer(0));
    last = digest;
  }
  std::ranges::sort(rows.newest, std::greater());
  std::ranges::sort(rows.earlier, std::greater());
  return rows;
}

/// Calls `take` with a row that is as it was written, and its payload.
/// \return whether there is such a row.
template <typename Take>
bool with_sound_row(Session& session, std::int64_t id, Take take) {
  return session.unless_damaged([&] {
    const Rows rows = session.query(
        "SELECT digest, robot, task, made_ms, crc32c, payload FROM rehearsal WHERE id = $1 AND " +
            session.is_intact("rehearsal"),
        id);
    if (rows.empty())
      return false;
    const Bytes payload = rows.front().column_blob(5);
    if (crc32c(payload) != rows.front().column_integer(4))
      return false;
    take(rows.front(), payload);
    return true;
  });
}

/// \return nothing if the row does not exist, is damaged or of another version.
std::optional<StoredRehearsal> read_rehearsal(Session& session, std::int64_t id) {
  std::optional<StoredRehearsal> rehearsal;
  with_sound_row(session, id, [&](const Row& row, Bytes payload) {
    rehearsal = StoredRehearsal{.id = id_of<Digest>(row.column_blob(0)),
                                .robot = id_of<Digest>(row.column_blob(1)),
                                .task = std::string(row.column_text(2)),
                                .made_ms = row.column_integer(3)};
    if (!decode_rehearsal(payload, *rehearsal))
      rehearsal.reset();
  });
  return rehearsal;
}

}  // namespace

void insert_rehearsal(Session& session, const StoredRehearsal& rehearsal) {
  const std::vector<std::uint8_t> payload = encode_rehearsal(rehearsal);
  if (StoredRehearsal read; !decode_rehearsal(payload, read))
    throw Failure(ErrorCode::InvalidInput, "rehearsal " + rehearsal.id.short_hex() +
                                               ": exceeds a limit and could not be read back");
  session.query(
      "INSERT INTO rehearsal (digest, robot, task, made_ms, crc32c, payload)"
      " VALUES ($1, $2, $3, $4, $5, $6)",
      rehearsal.id, rehearsal.robot, rehearsal.task, rehearsal.made_ms, crc32c(payload), payload);
}

std::vector<std::int64_t> find_surplus_rehearsals(Session& session, const RehearsalLimits& limits) {
  auto [newest, surplus] = session.unless_damaged([&] { return all_rows(session); });
  std::size_t count = 0;
  std::uint64_t bytes = 0;
  for (const std::int64_t row : newest) {
    const auto size = session.unless_damaged([&] {
      return session.find_integer(
          "SELECT CAST(length(payload) AS bigint) FROM rehearsal WHERE id = $1", row);
    });
    bytes += static_cast<std::uint64_t>(size.value_or(0));
    if (++count > 1 && (count > limits.count || bytes > limits.bytes))
      surplus.push_back(row);
  }
  return surplus;
}

std::vector<StoredRehearsal> select_rehearsals(Session& session, std::size_t limit) {
  std::vector<StoredRehearsal> rehearsals;
  for (const std::int64_t row : session.unless_damaged([&] { return all_rows(session).newest; })) {
    if (rehearsals.size() == limit)
      break;
    if (std::optional<StoredRehearsal> rehearsal = read_rehearsal(session, row))
      rehearsals.push_back(*std::move(rehearsal));
  }
  return rehearsals;
}

void delete_rehearsals_of(Session& session, std::string_view task) {
  session.query("DELETE FROM rehearsal WHERE task = $1", task);
}

bool is_rehearsal_sound(Session& session, std::int64_t row) {
  return with_sound_row(session, row, [](const Row& /*row*/, Bytes /*payload*/) {});
}

void drop_rehearsal(Session& session, std::int64_t row) {
  static_cast<void>(session.try_change("DELETE FROM rehearsal WHERE id = $1", row));
}

}  // namespace kinship::store
