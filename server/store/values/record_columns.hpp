#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "proto/types/attempt.hpp"
#include "server/store/values/columns.hpp"

/// The columns of table `attempt` that hold a PlanningRecord, from the table of its fields: both
/// engines list, bind, read and move them by it.
namespace kinship::store {

inline constexpr int kRecordColumns =
    std::tuple_size_v<std::remove_const_t<decltype(kFieldsOf<PlanningRecord>)>>;

/// The column of a field has the field's name, but for one.
constexpr std::string_view column_of(std::string_view field) {
  return field == "distribution_id" ? "distribution_digest" : field;
}

/// SQL that lists the columns, each behind a prefix, e.g. "attempt."; ends with a space.
std::string record_columns(std::string_view prefix = "");

/// The value of a column: std::int64_t, double, std::string_view or optional Bytes. Borrows texts
/// and bytes.
template <typename Member>
auto column_value(const Member& member) {
  if constexpr (std::is_same_v<Member, std::string>)
    return std::string_view(member);
  else if constexpr (std::is_same_v<Member, std::optional<Digest>>)
    return member ? std::optional(Bytes(member->bytes)) : std::nullopt;
  else if constexpr (std::is_enum_v<Member>)
    return code_of(member);
  else if constexpr (std::is_floating_point_v<Member>)
    return member;
  else
    return static_cast<std::int64_t>(member);
}
template <typename Member>
using ColumnValue = decltype(column_value(std::declval<const Member&>()));

/// The member that a column holds; the inverse of column_value().
template <typename Member, Columns Row>
Member read_column(const Row& row, int column) {
  if constexpr (std::is_same_v<Member, std::string>)
    return std::string(row.column_text(column));
  else if constexpr (std::is_same_v<Member, std::optional<Digest>>)
    return optional_id_of<Digest>(row, column);
  else if constexpr (std::is_same_v<Member, Outcome>)
    return outcome_of(row.column_integer(column));
  else if constexpr (std::is_same_v<Member, SamplingMode>)
    return mode_of(row.column_integer(column));
  else if constexpr (std::is_floating_point_v<Member>)
    return row.column_real(column);
  else {
    static_assert(std::integral<Member>, "no column of this type");
    return static_cast<Member>(row.column_integer(column));
  }
}

/// \param first_column  of record_columns().
template <Columns Row>
PlanningRecord read_record(const Row& row, int first_column) {
  PlanningRecord record;
  for_each_field<PlanningRecord>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    record.*field.member = read_column<T>(row, first_column++);
  });
  return record;
}

}  // namespace kinship::store
