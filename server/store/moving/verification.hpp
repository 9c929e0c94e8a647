#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/store/moving/copying.hpp"
#include "server/store/moving/pair_records.hpp"
#include "server/store/moving/side.hpp"

namespace kinship::store::moving {

/// The result of comparing a table of two stores.
struct VerifiedTable {
  std::string name;
  RowsSum source = {}, target = {};
  std::uint64_t differences = 0;  ///< rows missing, added or not the same
  std::uint64_t damaged = 0;      ///< rows that are the same, and damaged in both
};

struct Verification {
  std::vector<VerifiedTable> tables;
  std::uint64_t differences = 0;
  std::vector<std::string> messages;  ///< of the first differences and of the first damaged rows

  bool is_equal() const noexcept { return differences == 0; }
};

/// Compares each row of two stores, not written meanwhile, cell by cell. For a robot and task
/// compared before and unchanged since, it compares ids and the columns that may change.
Verification verify(Side& source, Side& target, const RowsDone& rows_done);

/// Compares the paths and attempts of each robot and task not compared before, while the source may
/// be written to; pairs that change meanwhile are left for verify().
Verification verify_beside_server(Side& source, Side& target, const RowsDone& rows_done);

}  // namespace kinship::store::moving
