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

/// Records that all rows of a robot and task were equal in both stores.
struct PairRecord {
  RowsSum paths, attempts;
};

std::uint32_t digest_of(const MovedRow& row, std::uint32_t before = 0);

/// Records of pairs compared beside a server, kept in the target until the move is done: a pair is
/// not compared again while its row of `experience` is unchanged.
class PairRecords {
 public:
  explicit PairRecords(Side& target) : target_(target) {}

  std::optional<PairRecord> find(const MovedRow& experience) const;
  void put(const MovedRow& experience, const PairRecord& record);

 private:
  Side& target_;
};

}  // namespace kinship::store::moving
