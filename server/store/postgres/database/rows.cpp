#include "server/store/postgres/database/rows.hpp"

#include <libpq-fe.h>

#include <bit>
#include <charconv>
#include <stdexcept>
#include <string>

namespace kinship::store::postgres {
namespace {

constexpr Oid kFloat8Type = 701;

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes)
    value = value << 8U | byte;
  return value;
}

}  // namespace

Bytes Row::column_blob(int column) const noexcept {
  return {reinterpret_cast<const std::uint8_t*>(PQgetvalue(result_, row_, column)),
          static_cast<std::size_t>(PQgetlength(result_, row_, column))};
}

std::string_view Row::column_text(int column) const noexcept {
  return {PQgetvalue(result_, row_, column),
          static_cast<std::size_t>(PQgetlength(result_, row_, column))};
}

bool Row::column_is_null(int column) const noexcept {
  return PQgetisnull(result_, row_, column) != 0;
}

std::int64_t Row::column_integer(int column) const {
  constexpr Oid kBoolType = 16, kInt8Type = 20, kInt2Type = 21, kInt4Type = 23;
  if (column_is_null(column))
    return 0;
  const std::uint64_t value = big_endian(column_blob(column));
  switch (PQftype(result_, column)) {
    case kBoolType:
    case kInt8Type:
      return static_cast<std::int64_t>(value);
    case kInt4Type:
      return static_cast<std::int32_t>(value);
    case kInt2Type:
      return static_cast<std::int16_t>(value);
    default:
      throw std::logic_error("column " + std::to_string(column) + " (" + PQfname(result_, column) +
                             ") is no integer");
  }
}

double Row::column_real(int column) const {
  if (column_is_null(column))
    return 0;
  if (PQftype(result_, column) != kFloat8Type)
    throw std::logic_error("column " + std::to_string(column) + " (" + PQfname(result_, column) +
                           ") is no double precision");
  return std::bit_cast<double>(big_endian(column_blob(column)));
}

int Rows::size() const noexcept { return PQntuples(result_.get()); }

int Rows::columns() const noexcept { return PQnfields(result_.get()); }

std::int64_t Rows::changed() const {
  const std::string_view text = PQcmdTuples(result_.get());
  std::int64_t rows = 0;
  std::from_chars(text.data(), text.data() + text.size(), rows);
  return rows;
}

std::string_view Rows::command_tag() const noexcept { return PQcmdStatus(result_.get()); }

void Rows::Clear::operator()(pg_result* result) const noexcept { PQclear(result); }

}  // namespace kinship::store::postgres
