#include "server/store/sqlite/upkeep/schema_recovery.hpp"

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "proto/files/file.hpp"

namespace kinship::store {
namespace {

/// An object of a schema.
struct SchemaObject {
  std::string sql;
  std::int64_t root = 0;  ///< page
};

std::map<std::string, SchemaObject> schema_of(Database& database) {
  std::map<std::string, SchemaObject> schema;
  Statement rows(database.connection(), "SELECT name, sql, rootpage FROM main.sqlite_master");
  while (rows.step())
    schema[std::string(rows.column_text(0))] = {std::string(rows.column_text(1)),
                                                rows.column_integer(2)};
  return schema;
}

SchemaState compare_schemas(Database& store, Database& fresh) {
  const auto state = store.unless_damaged([&]() -> std::optional<SchemaState> {
    const std::map<std::string, SchemaObject> found = schema_of(store);
    SchemaState same = SchemaState::Same;
    for (const auto& [name, object] : schema_of(fresh)) {
      const auto of_store = found.find(name);
      if (of_store == found.end() || of_store->second.sql != object.sql)
        return SchemaState::Damaged;
      if (of_store->second.root != object.root)
        same = SchemaState::Elsewhere;
    }
    return same;
  });
  return state.value_or(SchemaState::Damaged);
}

/// Of the header of a database: not its counters, page size or journal mode.
bool has_header_of(std::string_view header, std::string_view fresh) {
  constexpr std::size_t kBytes = 100;
  constexpr std::array<std::pair<std::size_t, std::size_t>, 3> kFixed = {
      {{0, 16}, {20, 24}, {44, 72}}};
  if (header.size() < kBytes)
    return false;
  return std::ranges::all_of(kFixed, [&](const auto& part) {
    return header.substr(part.first, part.second - part.first) ==
           fresh.substr(part.first, part.second - part.first);
  });
}

std::string read_bytes(const std::filesystem::path& file, std::size_t size, std::uint64_t at) {
  std::string bytes(size, '\0');
  bytes.resize(files::File(file, O_RDONLY).read(bytes.data(), size, at));
  return bytes;
}

/// Gives a copy of a store the schema of a new one, whose pages lie at the same places.
void take_over_schema(const std::filesystem::path& copy, Database& fresh,
                      const std::filesystem::path& fresh_file) {
  constexpr std::size_t kPageCountAt = 28, kFreePagesAt = 32, kFreeEnd = 40;
  const auto size = static_cast<std::size_t>(fresh.integer("PRAGMA page_size"));
  const auto pages = static_cast<std::uint32_t>(std::filesystem::file_size(copy) / size);
  const files::File target(copy, O_RDWR);
  Statement schema(fresh.connection(), "SELECT pageno FROM dbstat WHERE name = 'sqlite_schema'");
  while (schema.step()) {
    const std::uint64_t at = static_cast<std::uint64_t>(schema.column_integer(0) - 1) * size;
    std::string page = read_bytes(fresh_file, size, at);
    if (at == 0) {
      for (std::size_t i = 0; i < sizeof(pages); ++i)
        page[kPageCountAt + i] = static_cast<char>(pages >> (8 * (sizeof(pages) - 1 - i)));
      std::fill(page.begin() + kFreePagesAt, page.begin() + kFreeEnd, '\0');
    }
    target.write(page, at);
  }
}

}  // namespace

SchemaState state_of_schema(Database& store, const std::filesystem::path& file, Database& fresh,
                            const std::filesystem::path& fresh_file) {
  constexpr std::size_t kHeaderBytes = 100;
  if (!has_header_of(read_bytes(file, kHeaderBytes, 0), read_bytes(fresh_file, kHeaderBytes, 0)))
    return SchemaState::Damaged;
  return compare_schemas(store, fresh);
}

SchemaCopy::SchemaCopy(const std::filesystem::path& file, Database& fresh,
                       const std::filesystem::path& fresh_file)
    : file_(fresh_file.string() + std::string(kSuffix)) {
  std::filesystem::copy_file(file, file_, std::filesystem::copy_options::overwrite_existing);
  take_over_schema(file_, fresh, fresh_file);
  database_ = std::make_unique<Database>(file_, Access::ReadOnly);
}

SchemaCopy::~SchemaCopy() {
  database_.reset();
  std::error_code none;
  std::filesystem::remove(file_, none);
}

}  // namespace kinship::store
