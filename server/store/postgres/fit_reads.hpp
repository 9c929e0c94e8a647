#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/postgres/database/connection_pool.hpp"
#include "server/store/postgres/opening/primary.hpp"
#include "server/store/postgres/replica.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/contents.hpp"

namespace kinship::store::postgres {

/// The readings of fits: from a replica whose state has the wanted generation, else from the
/// primary. Successive readings of a robot and task never go back in time. May be shared between
/// threads.
class FitReads {
 public:
  /// \param primary, readers  outlive it; readers are connections to the primary.
  /// \param uses_replicas     false: the primary alone is read.
  FitReads(const Primary& primary, ConnectionPool& readers, bool uses_replicas);

  /// Notes that this server began a run, on a primary of a timeline. A standby with the row of that
  /// run has the history of that primary, not that of an earlier primary with rows lost since.
  void run_began(const Uuid& run, std::int64_t timeline);

  /// See Store.
  PathsRead paths(const Digest& robot, std::string_view task, const PathRange& range);
  std::vector<std::int64_t> path_ids(const Digest& robot, std::string_view task,
                                     std::uint64_t generation);
  SceneRead scene(std::int64_t id);

  std::vector<ReplicaUse> use() const;

 private:
  using Pair = std::pair<Digest, std::string>;
  /// Reads from a standby that has the history of the primary.
  using ReadReplica = std::function<Replica::Answer(Connection&)>;

  /// \param read      reads a value from one state of the database.
  /// \param is_whole  false if a part of it is damaged; then the primary is asked.
  template <typename Value, typename Read, typename IsWhole>
  Value read_pair(const Pair& pair, std::uint64_t generation, Read read, IsWhole is_whole);
  bool ask_replicas(std::size_t first, const ReadReplica& read);
  std::optional<Uuid> usable_run() const;
  std::uint64_t newest_read(const Pair& pair) const;
  void note_read(const Pair& pair, std::uint64_t generation);

  const Primary& primary_;
  ConnectionPool& readers_;
  std::vector<std::unique_ptr<Replica>> replicas_;

  mutable std::mutex mutex_;
  Uuid run_;                            // guarded by mutex_; zero: none
  std::int64_t timeline_ = 0;           // guarded by mutex_
  std::map<Pair, std::uint64_t> read_;  // guarded by mutex_: the newest generation of each
};

}  // namespace kinship::store::postgres
