#pragma once

#include <string>
#include <vector>

namespace kinship::store {

/// One page of a listing; `next_cursor` is empty on the last one.
///
/// Every listing gives at most `limit` rows after `cursor`, which is empty for the first page. Rows
/// added or removed between two pages neither repeat nor hide others. A listing throws
/// Failure(InvalidInput) for a cursor of another listing.
template <typename Row>
struct Page {
  std::vector<Row> rows;
  std::string next_cursor;
};

}  // namespace kinship::store
