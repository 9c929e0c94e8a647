#pragma once

#include <cstdint>
#include <optional>

#include "server/store/sqlite/database/statement.hpp"
#include "server/store/values/codes.hpp"

/// How values stand in the columns of a row.
namespace kinship::store {

template <typename Id>
std::optional<Id> optional_id_of(const Statement& row, int column) {
  if (row.column_is_null(column))
    return std::nullopt;
  return id_of<Id>(row.column_blob(column));
}

inline std::uint64_t count_of(const Statement& row, int column) {
  return static_cast<std::uint64_t>(row.column_integer(column));
}

}  // namespace kinship::store
