#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/files/named_store.hpp"
#include "server/store/sqlite/files/wal_frames.hpp"

namespace kinship::store {

/// Whether the open files of a store have what SQLite wrote there, whichever program that was. A
/// WAL may be reset, or shorter, once a checkpoint has moved its frames into the database file; it
/// may not lack a frame that the wal-index names, nor have another one in its place. The database
/// file changes while a checkpoint runs, which the wal-index tells, and never else: a sample of its
/// pages is compared. Used by one thread at a time.
class ContentWatch {
 public:
  /// Of files that were just opened, which are taken for right.
  void begin();

  /// \param writing  reads the wal-index of the files.
  /// \return Overwritten, WalDamaged, WalSpent or None.
  NamedStore::Finding look(Database& writing, const NamedStore& named, LookAt what);

  /// As of the last look; nothing before the first.
  const std::optional<WalIndex>& index() const noexcept { return index_; }

 private:
  /// When a file was last written, and how long it was then.
  struct Stamp {
    std::uint64_t size = 0;
    std::int64_t seconds = 0, nanoseconds = 0;
    bool operator==(const Stamp&) const = default;
  };
  /// Of the database file.
  struct Sample {
    std::uint32_t checksum = 0;
    WalIndex index;  // when it was taken, no checkpoint was running
  };

  static Stamp stamp_of(const files::File& file);
  bool is_overwritten(const files::File& file, const WalIndex& before, Database& writing);
  bool has_all_frames(const files::File& wal, const WalIndex& index, LookAt what);
  bool patrol(const files::File& wal, const Stamp& stamp, const WalIndex& index);

  std::optional<WalIndex> index_;
  std::optional<Sample> sample_;
  Stamp file_stamp_;              // as of the last look
  bool is_file_settled_ = false;  // it was so in two looks, the clock of files is that coarse

  std::optional<WalFrames> frames_;  // of the round of the patrol that is under way
  Stamp wal_stamp_, round_stamp_;    // as of the last look; when the round began
  bool is_round_settled_ = false;    // the WAL had been so in the look before
  bool is_wal_settled_ = false;      // a whole round found nothing, and nothing was written since
  std::chrono::steady_clock::time_point patrolled_{};
};

}  // namespace kinship::store
