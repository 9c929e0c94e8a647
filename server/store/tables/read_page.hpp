#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
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

/// The same of a feed. \param cursor  that it was asked for with.
template <typename Entry, typename Read, typename CursorOf>
Feed<Entry> read_feed(Rows rows, std::string_view cursor, std::size_t limit, Read read,
                      CursorOf cursor_of) {
  Feed<Entry> feed;
  feed.cursor = cursor;
  for (const Row& row : rows) {
    feed.has_more = feed.rows.size() == limit;
    if (feed.has_more)
      break;
    feed.rows.push_back(read(row));
    feed.cursor = cursor_of(row);
  }
  return feed;
}

}  // namespace kinship::store
