#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace kinship::store::moving {

/// What stands in a column: nothing, a number, or the bytes of a text or blob.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// A row of a table as both engines have it: the cells of its columns, the key first.
using MovedRow = std::vector<Cell>;

/// What tells that a row with an id has changed, without its blobs: the id and what may change.
using LightRow = std::array<std::int64_t, 4>;

/// The experience of a robot with a task.
struct Pair {
  std::int64_t task_id = 0;
  std::int64_t robot_id = 0;
};

inline std::int64_t integer_of(const MovedRow& row, std::size_t column) {
  const auto* const value = std::get_if<std::int64_t>(&row[column]);
  return value == nullptr ? 0 : *value;
}

}  // namespace kinship::store::moving
