#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/store/moving/side.hpp"

namespace kinship::store::moving {

/// Progress of a copy: rows of attempts and paths, about.
using RowsDone = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Makes a store equal to another: missing and differing rows are written, extra rows removed.
/// Equal rows are not read: for a robot and task their row of `experience` tells, else ids and the
/// columns that may change. So a copy continues one that was ended, and a second one brings later
/// changes. The source may be written to meanwhile: each pair is read in one state, and the next
/// copy brings later changes.
class Copying {
 public:
  Copying(Side& source, Side& target, RowsDone rows_done);

  void run();

  /// Rows written, by table.
  const std::map<std::string, std::uint64_t>& written() const noexcept { return written_; }

 private:
  /// The state of a robot and task to be copied.
  struct PairState {
    MovedRow experience;
    std::vector<RowFingerprint> attempts, paths;
  };

  void copy_names();
  void copy_robots(const std::vector<MovedRow>& robots);
  void copy_whole(const MovedTable& table, const std::vector<MovedRow>& rows);
  void erase_removed_robots();
  void copy_pairs();
  void copy_pair(const Pair& pair);
  PairState state_of(const Pair& pair);
  void copy_by_id(const MovedTable& table);
  void copy_ids(const MovedTable& table, const std::vector<std::int64_t>& ids);
  void bring_scenes(const MovedTable& table, const std::vector<MovedRow>& rows);
  void drop_unknown_paths(const MovedTable& table, std::vector<MovedRow>& rows) const;
  void write(const MovedTable& table, const std::vector<MovedRow>& rows);

  Side& source_;
  Side& target_;
  const RowsDone rows_done_;
  std::vector<MovedRow> experience_;      // of the source, as its names were read
  std::vector<MovedRow> removed_robots_;  // of the target, until no row refers to them
  std::set<std::int64_t> scenes_;         // that the target has
  std::set<std::int64_t> paths_;          // that the target has, of the pair under way
  std::map<std::string, std::uint64_t> written_;
  std::uint64_t done_ = 0, total_ = 0;
};

}  // namespace kinship::store::moving
