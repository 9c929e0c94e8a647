#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/store/moving/copying.hpp"
#include "server/store/moving/side.hpp"

namespace kinship::store::moving {

/// What a comparison of a table of two stores found.
struct VerifiedTable {
  std::string name;
  std::uint64_t source_rows = 0, target_rows = 0;
  std::uint32_t source_digest = 0, target_digest = 0;  ///< CRC-32C of all cells, in order
  std::uint64_t differences = 0;                       ///< rows missing, added or not the same
  std::uint64_t damaged = 0;  ///< rows that are the same, and damaged in both
};

struct Verification {
  std::vector<VerifiedTable> tables;
  std::uint64_t differences = 0;
  std::vector<std::string> messages;  ///< of the first differences and of the first damaged rows

  bool is_equal() const noexcept { return differences == 0; }
};

/// Compares each row of two stores that nobody writes to, cell by cell.
Verification verify(Side& source, Side& target, const RowsDone& rows_done);

}  // namespace kinship::store::moving
