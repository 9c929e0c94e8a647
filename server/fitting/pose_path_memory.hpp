#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/fitting/experience_choice.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::fitting {

/// Cache of the stored paths of tasks as pose paths, kept up to date with the store: known paths
/// are not read and computed again, unless paths of their robot were retired or the store has begun
/// a new epoch. Not shared between threads, except for bytes().
class PosePathMemory {
 public:
  struct Limits {
    std::size_t paths = 8192;  ///< of a task: about 45 MB
    /// Of all tasks. Evicts the least recently used task, never the one being read.
    std::size_t bytes = std::size_t{64} << 20U;
  };

  /// \param store, robots  outlive it.
  PosePathMemory(const store::ExperienceStore& store, runtime::RobotRegistry& robots)
      : PosePathMemory(store, robots, Limits{}) {}
  PosePathMemory(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                 const Limits& limits)
      : store_(store), robots_(robots), limits_(limits) {}

  /// The usable paths of a task now, in the order of arrival; above the limit the newest, equally
  /// many of each robot. Robots and paths that cannot be read are left out.
  /// \param sources   ascending; empty: all.
  /// \param since_ms  received at or after, Unix time, UTC; 0: all.
  /// \param stop      checked between pages of paths; the result is then incomplete.
  /// \throws Failure(Storage)
  std::vector<SharedPosePath> read(const std::string& task, const std::vector<Digest>& sources,
                                   std::int64_t since_ms, const std::stop_token& stop);

  std::uint64_t computed() const noexcept { return computed_; }  ///< paths, since construction
  std::size_t bytes() const noexcept { return bytes_; }  ///< in memory, about; from any thread

 private:
  struct KnownPath {
    std::int64_t id = 0;
    std::int64_t received_ms = 0;
    SharedPosePath path;
  };
  struct SourcePaths {
    std::uint64_t generation = 0, retired_generation = 0, dropped = 0;
    std::int64_t last_id = 0;      ///< read, usable or not
    std::size_t most = 0;          ///< that were kept of them
    bool is_cut = false;           ///< there were more
    std::vector<KnownPath> paths;  ///< by id
  };
  struct TaskPaths {
    std::map<Digest, SourcePaths> sources;
    std::uint64_t last_used = 0;
  };

  void forget_other_epochs();
  void update(TaskPaths& known, const std::string& task, const std::stop_token& stop);
  void update(SourcePaths& known, const store::ExperienceSummary& now, const std::string& task,
              std::size_t most, const std::stop_token& stop);
  bool read_new(SourcePaths& known, const store::ExperienceSummary& now, const std::string& task,
                std::size_t most, const std::stop_token& stop);
  void add(SourcePaths& known, const store::StoredPath& stored, const runtime::Robot& robot);
  void forget_dropped(SourcePaths& known, const store::ExperienceSummary& now,
                      const std::string& task) const;
  static std::size_t size_of(const TaskPaths& known);
  void make_room(std::string_view task);

  const store::ExperienceStore& store_;
  runtime::RobotRegistry& robots_;
  const Limits limits_;
  std::atomic<std::size_t> bytes_ = 0;
  Uuid epoch_;
  std::map<std::string, TaskPaths, std::less<>> tasks_;
  std::uint64_t uses_ = 0, computed_ = 0;
};

}  // namespace kinship::fitting
