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

/// Selects the robot and task that a statement reads, each empty for all.
struct PairFilter {
  std::optional<Digest> robot = {};
  std::string_view task = {};

  bool is_empty() const noexcept { return !robot && task.empty(); }

  /// A column of a table, and the SQL of its required value.
  struct Column {
    std::string name, id;
  };
  /// Columns task_id and robot_id of the filter. Adds its values to the parameters, which borrow
  /// them.
  std::vector<Column> columns(Session& session, std::vector<Parameter>& parameters) const;

  /// Adds its values to the parameters, which borrow them.
  /// \return " AND <table>.task_id = ... AND <table>.robot_id = ...", as far as the filter is set.
  std::string condition(Session& session, const std::string& table,
                        std::vector<Parameter>& parameters) const;
};

/// SQL for the id of the task that a parameter names, or of a robot.
std::string id_of_task(Session& session, const std::string& name);
std::string id_of_robot(Session& session, const std::string& digest);

/// Maximum rows of a page, from the caller's limit.
std::int64_t rows_of_page(std::size_t limit);

/// The id of the last row shown of a listing by falling ids; for an empty cursor an id above all
/// rows. \throws Failure(InvalidInput) for a cursor of another listing.
std::int64_t parse_falling_cursor(std::string_view cursor);

/// The same by rising ids; 0 for an empty cursor.
std::int64_t parse_rising_cursor(std::string_view cursor);

/// \throws Failure(InvalidInput) that names the cursor.
[[noreturn]] void refuse_cursor(std::string_view cursor);

/// Reads a page of `limit` entries; the rows have one more if another page follows.
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

/// The same of a feed. \param cursor  of the caller.
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
