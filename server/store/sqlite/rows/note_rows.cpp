#include "server/store/sqlite/rows/note_rows.hpp"

namespace kinship::store {
namespace {

// Other settings have no colon in their names.
constexpr std::string_view kNote = "note:";

}  // namespace

std::map<std::string, std::string> select_notes(Database& database, std::string_view prefix) {
  const std::string first = std::string(kNote) + std::string(prefix);
  std::map<std::string, std::string> notes;
  const auto query = database.cached("SELECT key, value FROM setting WHERE key >= ? ORDER BY key");
  query->bind(1, std::string_view(first));
  while (query->step() && query->column_text(0).starts_with(first))
    notes.emplace(query->column_text(0).substr(kNote.size()), query->column_text(1));
  return notes;
}

void write_notes(Database& database,
                 const std::map<std::string, std::optional<std::string>>& notes) {
  for (const auto& [name, text] : notes) {
    const std::string key = std::string(kNote) + name;
    if (text)
      database.cached("INSERT OR REPLACE INTO setting (key, value) VALUES (?, ?)")
          ->bind_all(std::string_view(key), std::string_view(*text))
          .run();
    else
      database.cached("DELETE FROM setting WHERE key = ?")->bind(1, std::string_view(key)).run();
  }
}

}  // namespace kinship::store
