#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "proto/types/conversations.hpp"
#include "server/app/row_cursor.hpp"
#include "server/service/admin_page.hpp"

namespace kinship::app {

/// A row as the JSON document that goes over the wire and into `--json` output.
std::string to_json(const service::AdminRow& row);

/// The page as a reply of any size.
AdminReply to_reply(const service::AdminPage& page);

/// Whether the rows of a reply fit into one page.
bool fits_page(const AdminReply& reply);

/// The request again for fewer rows than `rows`, which did not fit a page; empty if that would not
/// help: only the number of rows of a listing can be chosen, and one row cannot be halved.
std::optional<AdminRequest> for_fewer_rows(const AdminRequest& request, std::size_t rows);

/// The request to the service whose answer contains the rest of a row: for a listing, that row
/// alone.
AdminRequest for_rest(const AdminRequest& request, const RowCursor& begin);

}  // namespace kinship::app
