#pragma once

#include <cstddef>

#include "proto/types/conversations.hpp"
#include "server/service/admin_page.hpp"

namespace kinship::service {

// Approximate size of a reply on the network.
std::size_t reply_bytes(const FetchReply& reply);
std::size_t reply_bytes(const AdminPage& page);

}  // namespace kinship::service
