#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "server/store/session.hpp"
#include "server/store/store.hpp"

/// The pages of listings. A cursor is the sort key of the last row shown.
namespace kinship::store {

/// Says which robots and tasks a statement reads, each empty for all.
struct PairFilter {
  std::optional<Digest> robot = {};
  std::string_view task = {};

  bool is_empty() const noexcept { return !robot && task.empty(); }

  /// A column of a table, and the SQL of what it has to be.
  struct Column {
    std::string name, id;
  };
  /// task_id and robot_id, of what it asks for, which is added to the parameters; they borrow it.
  std::vector<Column> columns(std::vector<Parameter>& parameters) const;

  /// Adds what it asks for to the parameters.
  /// \return " AND <table>.task_id = ... AND <table>.robot_id = ...", of what it asks for.
  std::string condition(const std::string& table, std::vector<Parameter>& parameters) const;
};

/// How many rows a page may have that was asked for with a limit.
std::int64_t rows_of_page(std::size_t limit);

/// The id of the last row shown of a listing by falling ids; at the beginning one that no row
/// reaches. \throws Failure(InvalidInput) for a cursor of another listing.
std::int64_t parse_falling_cursor(std::string_view cursor);

/// The same by rising ids; at the beginning 0.
std::int64_t parse_rising_cursor(std::string_view cursor);

/// \throws Failure(InvalidInput) that names it.
[[noreturn]] void refuse_cursor(std::string_view cursor);

/// Reads a page of `limit` entries from rows of which there is one more where another page follows.
/// \param read       makes an entry of a row.
/// \param cursor_of  the cursor that continues after the row.
template <typename Entry, typename Read, typename CursorOf>
Page<Entry> read_page(Rows rows, std::int64_t limit, Read read, CursorOf cursor_of) {
  Page<Entry> page;
  std::string cursor;
  for (const Row& row : rows) {
    if (std::ssize(page.rows) == limit) {
      page.next_cursor = std::move(cursor);
      break;
    }
    page.rows.push_back(read(row));
    cursor = cursor_of(row);
  }
  return page;
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
