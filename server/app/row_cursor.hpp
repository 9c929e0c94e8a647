#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"

/// Rows that are longer than a page go out in pieces: `AdminReply::last_row_continues`.
namespace kinship::app {

/// Where a page begins: in the middle of the rows of one answer of the service.
struct RowCursor {
  std::string inner;        ///< the service's cursor of that answer
  std::size_t row = 0;      ///< of its rows
  std::size_t byte = 0;     ///< of that row
  std::uint64_t check = 0;  ///< fingerprint() of that row
};

/// A hash of the row; it shows whether the row changed between two pages.
std::uint64_t fingerprint(const std::string& row);

std::string to_text(const RowCursor& cursor);

/// \return the place if the cursor is one of to_text(), otherwise the beginning of the service's
///         answer to the cursor; InvalidInput for a malformed cursor of to_text().
Result<RowCursor> read_row_cursor(const std::string& cursor);

/// The part of a reply that a page carries: all of it if it fits, else as much as fits from `begin`
/// on, the last row cut between two characters, with the cursor of the rest.
/// \param reply  the whole answer of the service, with the service's next_cursor.
/// \return       Failed if the row in which the page begins has changed.
AdminReply page_of(AdminReply reply, const RowCursor& begin);

}  // namespace kinship::app
