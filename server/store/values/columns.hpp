#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/store/values/bytes.hpp"
#include "server/store/values/codes.hpp"

/// The columns of a row of a query, of any engine.
namespace kinship::store {

/// Columns count from 0; the value of a NULL column is 0 or empty. Texts and bytes are valid until
/// the next row.
template <typename Row>
concept Columns = requires(const Row& row, int column) {
  { row.column_is_null(column) } -> std::convertible_to<bool>;
  { row.column_integer(column) } -> std::convertible_to<std::int64_t>;
  { row.column_real(column) } -> std::convertible_to<double>;
  { row.column_text(column) } -> std::convertible_to<std::string_view>;
  { row.column_blob(column) } -> std::convertible_to<Bytes>;
};

template <Columns Row>
std::uint64_t count_of(const Row& row, int column) {
  return static_cast<std::uint64_t>(row.column_integer(column));
}

template <typename Id, Columns Row>
std::optional<Id> optional_id_of(const Row& row, int column) {
  if (row.column_is_null(column))
    return std::nullopt;
  return id_of<Id>(row.column_blob(column));
}

template <Columns Row>
std::optional<std::int64_t> optional_integer_of(const Row& row, int column) {
  if (row.column_is_null(column))
    return std::nullopt;
  return row.column_integer(column);
}

}  // namespace kinship::store
