#include "server/store/tables/settings.hpp"

namespace kinship::store {
namespace {

// Other settings have no colon in their names.
constexpr std::string_view kNote = "note:";

}  // namespace

std::string read_setting(Session& session, std::string_view key) {
  const Rows rows = session.query(
      "SELECT value FROM setting WHERE key = $1 AND " + session.is_intact("setting"), key);
  return rows.empty() ? "" : std::string(rows.front().column_text(0));
}

void write_setting(Session& session, std::string_view key,
                   const std::optional<std::string>& value) {
  if (value)
    session.query(
        "INSERT INTO setting (key, value) VALUES ($1, $2)"
        " ON CONFLICT (key) DO UPDATE SET value = excluded.value",
        key, *value);
  else
    session.query("DELETE FROM setting WHERE key = $1", key);
}

std::map<std::string, std::string> select_notes(Session& session, std::string_view prefix) {
  std::map<std::string, std::string> notes;
  for (const Row& row :
       session.query("SELECT key, value FROM setting WHERE substr(key, 1, length($1)) = $1 AND " +
                         session.is_intact("setting"),
                     std::string(kNote) + std::string(prefix)))
    notes.emplace(row.column_text(0).substr(kNote.size()), row.column_text(1));
  return notes;
}

void write_notes(Session& session, const std::map<std::string, std::optional<std::string>>& notes) {
  for (const auto& [name, text] : notes)
    write_setting(session, std::string(kNote) + name, text);
}

}  // namespace kinship::store
