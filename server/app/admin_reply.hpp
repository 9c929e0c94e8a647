#pragma once

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

}  // namespace kinship::app
