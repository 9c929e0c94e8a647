#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "server/store/sqlite/database/page_scan.hpp"

/// Rows as they lie in the pages of a file, without its schema, its indexes and the pages that lead
/// to them: all of those may be damaged.
namespace kinship::store {

/// A value of a record: NULL, integer, real, text or blob.
using RawValue =
    std::variant<std::monostate, std::int64_t, double, std::string, std::vector<std::uint8_t>>;

struct RawRow {
  std::int64_t id = 0;           ///< of the row; its own column of the record is NULL
  std::vector<RawValue> values;  ///< all columns of the record
};

/// Hands over every row on every page of a table that can be read wholly, in no order. Pages that
/// are free hold none: the writer clears them (PRAGMA secure_delete).
/// \param progress  called now and then with 0 to 1.
/// \return the number of damaged pages.
std::uint64_t for_each_row(PageReader& reader, const std::function<void(RawRow)>& take,
                           const std::function<void(double)>& progress);

}  // namespace kinship::store
