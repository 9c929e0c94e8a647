#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/types/distribution.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/fitting/known_paths.hpp"
#include "server/fitting/memory_ceiling.hpp"
#include "server/fitting/path_transfer.hpp"
#include "server/fitting/pooled_configurations.hpp"
#include "server/fitting/target_memory.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"
#include "server/transfer/transferred_path.hpp"

namespace kinship::fitting {

/// Outcome of the experience of one source robot in a fit.
struct SourceSummary {
  Source source;                     ///< without its mass
  std::uint64_t paths_selected = 0;  ///< selected by the key: all, or since its date
  std::uint64_t paths_left_out = 0;  ///< bad data
  std::string problem;               ///< of the robot, or of the first path left out
  std::uint64_t paths_blocked = 0;   ///< no configuration is free in their recorded scene
  std::uint64_t paths_with_approximate_scene = 0;  ///< with solids around meshes in it
  std::string scene_problem;  ///< an ignored object of a recorded scene; empty: none
  bool has_placed = false, has_unplaced = false;
};

/// A source before its transfer; its label is a short digest.
Source source_of(const store::ExperienceSummary& experience);

/// Reads the paths of source robots and transfers them into a pool of the target's configurations.
class SourceTransfer {
 public:
  struct Options {
    /// Paths of an earlier fit of the same key, reused if the store still has them. Outlive the
    /// transfer, may be null.
    const KnownPaths* known = nullptr;
    int threads = 1;  ///< of the transfer; the result does not depend on it
    std::function<bool(const Uuid& report)> leaves_out = {};  ///< see FitContext
    MemoryCeiling* memory = nullptr;  ///< outlives the transfer; null: there is no limit
    TargetMemory* targets = nullptr;  ///< cache of targets; null: the target is prepared anew
  };

  /// \param robots, store, key, target  outlive it.
  SourceTransfer(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                 const DistributionKey& key, const runtime::Robot& target)
      : SourceTransfer(store, robots, key, target, Options{}) {}
  SourceTransfer(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                 const DistributionKey& key, const runtime::Robot& target, const Options& options);

  /// Number of paths of the source that the key selects.
  std::uint64_t count_selected(const store::ExperienceSummary& experience,
                               const std::stop_token& stop) const;

  /// Reserves the memory that the paths and a fit of them could need, until the transfer ends.
  /// \param wanted  paths, one number per source.
  /// \throws Failure(TooLarge), with both numbers, if it exceeds the limit; Failure(Storage);
  ///         Stopped.
  void reserve(const std::vector<store::ExperienceSummary>& experience,
               const std::vector<std::uint64_t>& wanted, const std::stop_token& stop);

  /// Adds `wanted` of the `selected` paths of a source, spread evenly over their order of arrival.
  /// Bad paths and robots that cannot be read are left out; the summary says so.
  /// \param stop  checked between groups of paths; the transfer is then incomplete.
  /// \throws Failure(Storage); Failure(TooLarge) if they need more than was reserved.
  SourceSummary add(const store::ExperienceSummary& experience, std::uint64_t selected,
                    std::uint64_t wanted, const std::stop_token& stop);

  const PooledConfigurations& pool() const noexcept { return pool_; }
  /// The paths used, including those without configurations.
  const KnownPaths& used() const noexcept { return used_; }
  std::uint64_t transferred() const noexcept { return transferred_; }  ///< of used(), the new ones

 private:
  void add_paths(const runtime::Robot& robot, std::uint64_t wanted, const std::stop_token& stop,
                 SourceSummary& summary);
  static void count_scene(const KnownPath& path, SourceSummary& summary);
  void add_path(const store::StoredPath& stored, const PathOutcome& outcome,
                SourceSummary& summary);

  const store::ExperienceStore& store_;
  runtime::RobotRegistry& robots_;
  const DistributionKey& key_;
  const runtime::Robot& target_;
  const TargetMemory::Target prepared_target_;
  const std::function<bool(const Uuid& report)> leaves_out_;
  const int threads_;
  MemoryCeiling* const memory_;
  MemoryCeiling::Reservation reservation_;
  std::size_t reserved_bytes_ = 0;
  PathTransfer transfer_;
  PooledConfigurations pool_;
  KnownPaths used_;
  std::uint64_t transferred_ = 0;
};

/// Adds every source's share of at most `max_paths` paths.
/// \return the outcome of each source, in their order.
/// \throws Failure(Storage); Failure(TooLarge), before the first, if they could need more memory
///         than the limit; Stopped.
std::vector<SourceSummary> transfer_sources(SourceTransfer& transfer, const DistributionKey& key,
                                            const std::vector<store::ExperienceSummary>& experience,
                                            std::size_t max_paths, const std::stop_token& stop);

}  // namespace kinship::fitting
