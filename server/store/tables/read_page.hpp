#pragma once

#include <cstdint>
#include <utility>

#include "server/store/session.hpp"
#include "server/store/values/pages.hpp"

namespace kinship::store {

/// Reads a page of `limit` entries from rows of which there is one more where another page follows.
/// \param read       makes an entry of a row.
/// \param cursor_of  the cursor that continues after the row.
template <typename Entry, typename Read, typename CursorOf>
Page<Entry> read_page(Rows rows, std::int64_t limit, Read read, CursorOf cursor_of) {
  PageFiller<Entry> page(limit);
  for (const Row& row : rows)
    if (!page.add(read(row), cursor_of(row)))
      break;
  return page.take();
}

}  // namespace kinship::store
