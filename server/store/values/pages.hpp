#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "server/store/store.hpp"

/// The pages of listings. A cursor is the sort key of the last row shown.
namespace kinship::store {

/// How many rows a page may have that was asked for with a limit.
std::int64_t rows_of_page(std::size_t limit);

/// The id of the last row shown of a listing by falling ids; at the beginning one that no row
/// reaches. \throws Failure(InvalidInput) for a cursor of another listing.
std::int64_t parse_falling_cursor(std::string_view cursor);

/// The same by rising ids; at the beginning 0.
std::int64_t parse_rising_cursor(std::string_view cursor);

/// \throws Failure(InvalidInput) that names it.
[[noreturn]] void refuse_cursor(std::string_view cursor);

/// Fills a page with so many rows; a row more says that another page follows.
template <typename Row>
class PageFiller {
 public:
  explicit PageFiller(std::int64_t rows) : rows_(rows) {}

  /// \param cursor  that continues after this row.
  /// \return false if the page was full: nothing more belongs into it.
  bool add(Row row, std::string cursor) {
    if (std::ssize(page_.rows) == rows_) {
      page_.next_cursor = std::move(cursor_);
      return false;
    }
    page_.rows.push_back(std::move(row));
    cursor_ = std::move(cursor);
    return true;
  }
  Page<Row> take() { return std::move(page_); }

 private:
  std::int64_t rows_;
  std::string cursor_;
  Page<Row> page_;
};

}  // namespace kinship::store
