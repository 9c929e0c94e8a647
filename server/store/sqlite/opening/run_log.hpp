#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/uuid.hpp"
#include "server/store/values/history_seal.hpp"

namespace kinship::store {

/// The runs of a store (positions: the largest id of an attempt by then), oldest first: each wrote
/// what lies between its start and the start of the next one. Once a file is rolled back and
/// written anew, points of the lost runs, and those of the run that was cut off which lie behind
/// the cut, are not on it any more, whatever its position is by now. (Like the timelines of
/// PostgreSQL.)
class RunLog {
 public:
  explicit RunLog(const Uuid& epoch) : epoch_(epoch) {}

  const Uuid& epoch() const noexcept { return epoch_; }
  bool is_empty() const noexcept { return runs_.empty(); }

  /// A run begins. One before it that wrote nothing is forgotten, for no point names it; of more
  /// than 256 runs the oldest are.
  void begin(const Uuid& run, std::uint64_t position);

  /// The name of a position: the run that wrote it, which is there if there is any run.
  HistoryPoint at(std::uint64_t position) const;

  /// Whether what was there at a point is there at `position`, which is that of now.
  bool contains(const HistoryPoint& point, std::uint64_t position) const;

  std::string text() const;
  static std::optional<RunLog> parse(std::string_view text);  ///< empty if it is no text of one

 private:
  struct Run {
    Uuid id;
    std::uint64_t start = 0;  ///< position when it began
  };

  Uuid epoch_;
  std::uint64_t forgotten_until_ = 0;  ///< positions up to this may be of runs that were forgotten
  std::vector<Run> runs_;
};

}  // namespace kinship::store
