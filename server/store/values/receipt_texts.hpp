#pragma once

#include <cstdint>
#include <string>

#include "proto/types/conversations.hpp"

/// What receipts say.
namespace kinship::store {

/// Refused, and why.
inline Receipt refused(const Uuid& report_uuid, const std::string& why) {
  return {report_uuid, ReceiptStatus::Refused, "attempt " + report_uuid.text() + ": " + why};
}

/// Why a report's path was not kept.
inline std::string beyond_cap_text(std::uint64_t max_paths) {
  return "recorded, but its path is not kept: its robot and task have " +
         std::to_string(max_paths) + " paths, the most that are kept (--max-paths-per-pair)";
}

}  // namespace kinship::store
