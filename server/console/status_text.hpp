#pragma once

#include <string>

#include "server/service/service.hpp"

namespace kinship::console {

/// What the console's pages show of the server now, as a JSON document: {"now_ms", "status": as
/// `kinship status --json` has it, "disk": {"free", "capacity"} or null, "attempts": {receipt:
/// number}, "fetches": {outcome: number}, "receipts": {"bounds_s", "counts"}}; or {"message"}.
/// Reads the store's status.
std::string status_text(const service::Service& service) noexcept;

}  // namespace kinship::console
