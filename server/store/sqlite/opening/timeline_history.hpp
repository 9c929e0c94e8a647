#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/uuid.hpp"
#include "server/store/values/consistency_token.hpp"

namespace kinship::store {

/// The timeline of a store: its runs, oldest first. A position is the largest id of an attempt;
/// each run wrote the positions between its start and the start of the next run. Once a file is
/// rolled back and written again, points of the lost runs, and points behind the cut of the run
/// that was cut off, are not on the timeline any more, for every later position. (Like the
/// timelines of PostgreSQL.)
class TimelineHistory {
 public:
  explicit TimelineHistory(const Uuid& epoch) : epoch_(epoch) {}

  const Uuid& epoch() const noexcept { return epoch_; }
  bool is_empty() const noexcept { return runs_.empty(); }

  /// Begins a run. A previous run that wrote nothing is forgotten, as points never name it; of more
  /// than 256 runs the oldest are forgotten.
  void begin(const Uuid& run, std::uint64_t position);

  /// The point of a position: with the run that wrote it; empty only without runs.
  LogPosition at(std::uint64_t position) const;

  /// Whether the history up to a point is part of the store at `position`, the current one.
  bool contains(const LogPosition& point, std::uint64_t position) const;

  std::string text() const;
  static std::optional<TimelineHistory> parse(
      std::string_view text);  ///< empty: no result of text()

 private:
  struct Run {
    Uuid id;
    std::uint64_t start = 0;  ///< position when it began
  };

  Uuid epoch_;
  std::uint64_t forgotten_until_ = 0;  ///< positions up to this may be of forgotten runs
  std::vector<Run> runs_;
};

}  // namespace kinship::store
