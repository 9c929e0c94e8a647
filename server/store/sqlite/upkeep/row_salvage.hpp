#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "server/store/sqlite/database/page_scan.hpp"

/// Rows read directly from the pages of a file, without its schema, indexes and interior pages,
/// which may all be damaged.
namespace kinship::store {

/// A value of a record: NULL, integer, real, text or blob.
using RawValue =
    std::variant<std::monostate, std::int64_t, double, std::string, std::vector<std::uint8_t>>;

struct RawRow {
  std::int64_t id = 0;           ///< of the row; its own column of the record is NULL
  std::vector<RawValue> values;  ///< all columns of the record
};

/// Passes every row that can be read completely, from every page of a table, in no order. Free
/// pages hold none: the writer clears them (PRAGMA secure_delete).
/// \param progress  called now and then with 0 to 1.
/// \return the number of damaged pages.
std::uint64_t for_each_row(PageReader& reader, const std::function<void(RawRow)>& take,
                           const std::function<void(double)>& progress);

}  // namespace kinship::store
