#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <string>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/high_water_mark_file.hpp"
#include "server/store/sqlite/opening/timeline_history.hpp"
#include "server/store/store.hpp"
#include "server/store/values/consistency_token.hpp"

namespace kinship::store {

/// Writes a new epoch, without a run, and the identity of the file into a store, in the caller's
/// transaction.
/// \param before  an epoch of the same store, if none is written there; zeros: it is a new one.
Uuid write_new_epoch(Database& database, const std::filesystem::path& file,
                     const Uuid& before = {});

/// The version of Kinship that last began an epoch or wrote a report; empty: none that says so.
std::string release_of(Database& database);

/// The largest id of an attempt: the position of the state that a connection sees.
std::uint64_t position_of(Database& database);

/// The epoch of a store, the position of its history, and whether a client's consistency token
/// lies on it. May be shared between threads, except methods that take a connection, which belongs
/// to the caller's thread.
class History {
 public:
  explicit History(const std::filesystem::path& file);

  /// Begins a run on a connection just opened for writing. If the file has another identity than
  /// the stored one, or lies behind its high-water mark or the last commit of this object, it was
  /// copied or rolled back: a new epoch begins. Otherwise nothing is written, except in a new
  /// epoch, so that a store on a full disk can be opened.
  /// \throws Failure(Storage) if it cannot be written.
  void begin_run(Database& database);

  /// Writes the run in the transaction of its first attempts. Call it on the writer's thread, like
  /// committed(), which takes each position once it is durable.
  void write_run(Database& database);
  void committed(std::uint64_t position);

  Uuid epoch() const;
  StorePoint point() const;
  std::uint64_t position() const;  ///< of the last attempt that is durable
  bool has_lost(const ConsistencyToken& token) const;

  std::uint64_t rollbacks() const;  ///< noticed by this object
  std::string trouble() const;      ///< the last rollback, as text; empty: none

  /// Begins a new epoch through the writer's queue, because of a client's token. Does nothing if
  /// the token is not lost any more.
  class Renewal;

 private:
  struct State {
    Digest key;
    TimelineHistory log{Uuid{}};
    std::uint64_t position = 0;  ///< durable
    std::uint64_t rollbacks = 0;
    std::string trouble;
  };

  std::string find_rollback(const State& before, const TimelineHistory& log, std::uint64_t position,
                            const std::string& stored_identity) const;
  void write_high_water_mark() const;

  const std::filesystem::path file_;
  const HighWaterMarkFile high_water_mark_;
  bool is_run_written_ = false;  // of the writer's thread alone
  mutable std::mutex mutex_;
  State state_;  // guarded by mutex_
};

class History::Renewal : public WriteItem {
 public:
  /// \param history, token  outlive the item, which is done when its result is set.
  Renewal(History& history, const ConsistencyToken& token) : history_(history), token_(token) {}

  std::future<bool> result() { return promise_.get_future(); }  ///< whether an epoch began
  void apply(Batch& batch) override;
  void finish(const Error* error) override;

 private:
  History& history_;
  const ConsistencyToken& token_;
  std::optional<TimelineHistory> log_;  // empty: nothing was to be done
  std::uint64_t position_ = 0;
  std::promise<bool> promise_;
};

}  // namespace kinship::store
