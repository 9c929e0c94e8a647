#pragma once

#include <cstdint>
#include <optional>

#include "server/store/moving/side.hpp"

namespace kinship::store::moving {

/// Rows of a table, and the CRC-32C of all of their cells, in order.
struct RowsSum {
  std::uint64_t rows = 0;
  std::uint32_t digest = 0;
};

/// That all rows of a robot and task were the same in both stores.
struct PairRecord {
  RowsSum paths, attempts;
};

std::uint32_t digest_of(const MovedRow& row, std::uint32_t before = 0);

/// What was compared of pairs while a server went on, kept with the target until the move is done:
/// it need not be compared again while the row of `experience` is as it was then.
class PairRecords {
 public:
  explicit PairRecords(Side& target) : target_(target) {}

  std::optional<PairRecord> find(const MovedRow& experience) const;
  void put(const MovedRow& experience, const PairRecord& record);

 private:
  Side& target_;
};

}  // namespace kinship::store::moving
