#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "proto/types/conversations.hpp"
#include "server/service/administration.hpp"

namespace kinship::app {

/// A row as the JSON document that goes over the wire and into `--json` output.
std::string to_json(const service::AdminRow& row);

/// The page as a reply. Failed if its only row exceeds kMaxPageBytes.
AdminReply to_reply(const service::AdminPage& page);

/// Whether the rows of a reply fit into one page.
bool fits_page(const AdminReply& reply);

/// The question again for fewer rows than the `rows` that were too much for a page; empty if that
/// would not help: what is shown has the rows it has, and one row cannot be halved.
std::optional<AdminRequest> for_fewer_rows(const AdminRequest& request, std::size_t rows);

/// Failed, with the size of the rows and the limit, for a page that no smaller question makes fit.
AdminReply too_large(const AdminReply& reply);

}  // namespace kinship::app
