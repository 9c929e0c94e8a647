#pragma once

#include <cstdint>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <string>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/opening/run_log.hpp"
#include "server/store/sqlite/opening/witness_file.hpp"
#include "server/store/store.hpp"
#include "server/store/values/history_seal.hpp"

namespace kinship::store {

/// Writes a new epoch, with no run yet, and which file it is of, into a store. In a transaction of
/// the caller.
Uuid write_new_epoch(Database& database, const std::filesystem::path& file);

/// The largest id of an attempt: the position of what a connection sees.
std::uint64_t position_of(Database& database);

/// Which epoch a store is in, how far its history has come, and whether a point that somebody was
/// told of lies on it. May be shared between threads, except where it takes a connection, which
/// belongs to the caller's thread.
class History {
 public:
  explicit History(const std::filesystem::path& file);

  /// A run begins on a connection that was just opened for writing. If the file is not the one
  /// that it was written as, or lies behind its witness, or behind what this object saw committed,
  /// it was copied or rolled back: a new epoch begins. Otherwise nothing is written: a store on a
  /// full disk can be opened.
  /// \throws Failure(Storage) if it cannot be written.
  void begin_run(Database& database);

  /// Writes the run with its first attempts, into the same transaction. On the writer's thread,
  /// like committed(), which is to be told of each position once it is durable.
  void write_run(Database& database);
  void committed(std::uint64_t position);

  Uuid epoch() const;
  StorePoint point() const;
  bool has_lost(const HistoryMark& mark) const;

  std::uint64_t rollbacks() const;  ///< noticed by this object
  std::string trouble() const;      ///< what was noticed last, for people; empty: nothing

  /// A new epoch through the writer's queue, because of what a client knows. Does nothing if
  /// nothing is lost any more.
  class Renewal;

 private:
  struct State {
    Digest key;
    RunLog log{Uuid{}};
    std::uint64_t position = 0;  ///< durable
    std::uint64_t rollbacks = 0;
    std::string trouble;
  };

  std::string find_rollback(const State& before, const RunLog& log, std::uint64_t position,
                            const std::string& stored_identity) const;
  void testify() const;

  const std::filesystem::path file_;
  const WitnessFile witness_;
  bool is_run_written_ = false;  // of the writer's thread alone
  mutable std::mutex mutex_;
  State state_;  // guarded by mutex_
};

class History::Renewal : public WriteItem {
 public:
  /// \param history, mark  outlive the item, which is done when its result is there.
  Renewal(History& history, const HistoryMark& mark) : history_(history), mark_(mark) {}

  std::future<bool> result() { return promise_.get_future(); }  ///< whether an epoch began
  void apply(Batch& batch) override;
  void finish(const Error* error) override;

 private:
  History& history_;
  const HistoryMark& mark_;
  std::optional<RunLog> log_;  // empty: nothing was to be done
  std::uint64_t position_ = 0;
  std::promise<bool> promise_;
};

}  // namespace kinship::store
