#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>

#include "proto/types/summaries.hpp"
#include "server/store/postgres/database/connection_pool.hpp"
#include "server/store/postgres/database/connection_string.hpp"

namespace kinship::store::postgres {

/// A host of the database that may be a standby, read while it is one and answers. After a missing
/// answer it is not asked for a while, twice as long each time; then one reader tries it, and the
/// others go on without it. May be shared between threads.
class Replica {
 public:
  /// The outcome of a reading.
  enum class Answer {
    Read,     ///< done
    Behind,   ///< it does not have the wanted state yet
    Primary,  ///< it takes writes: not to be read as a replica
    Damaged,  ///< its data cannot be read
    Failed,   ///< it did not answer, or ended the reading to replay changes
    LeftOut   ///< was not asked
  };
  using Read = std::function<Answer(Connection&)>;

  Replica(const ConnectionString& host, const ConnectionOptions& options);

  /// Runs `read` on one state of the database. A PostgresError is neither thrown nor followed by
  /// another try.
  Answer read(const Read& read);

  ReplicaUse use() const;

 private:
  using Clock = std::chrono::steady_clock;

  bool begin();
  void end(Answer answer, const std::string& message, bool is_away);

  const ConnectionString host_;
  std::atomic<bool> is_pooled_ = false;
  const ConnectionOptions options_;  // with is_pooled_
  ConnectionPool pool_;

  mutable std::mutex mutex_;
  ReplicaUse use_;                     // guarded by mutex_
  bool is_left_alone_ = false;         // guarded by mutex_: until one reader has tried it
  bool is_tried_ = false;              // guarded by mutex_: by that one
  Clock::time_point left_until_ = {};  // guarded by mutex_
  Clock::duration pause_ = {};         // guarded by mutex_: the last one, for want of an answer
};

}  // namespace kinship::store::postgres
