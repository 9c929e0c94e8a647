#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship::link {

/// What a store that an outbox never saw is sent of the reports that are there already. A store
/// that was put back is none: what it lost is sent again by itself.
enum class Resend {
  Unacknowledged,  ///< what no store has acknowledged
  All,             ///< that, and what older stores acknowledged, as far as it is kept
  None             ///< only what is reported from now on
};

/// \param word  "all" or "none"; empty: Unacknowledged.
Result<Resend> parse_resend(std::string_view word);

/// Reports that an outbox keeps for a store that its server had before.
struct KeptReports {
  std::string store;        ///< store_name()
  std::size_t reports = 0;  ///< acknowledged by it, or held back
};

/// "240 reports of an older store (ba62759c-d634) are kept", and how they are sent; empty: nothing
/// is kept.
std::string describe(const std::vector<KeptReports>& kept);

}  // namespace kinship::link
