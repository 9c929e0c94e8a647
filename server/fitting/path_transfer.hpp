#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "server/fitting/distribution_key.hpp"
#include "server/fitting/known_paths.hpp"
#include "server/fitting/scene_filters.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"
#include "server/transfer/arm_pair.hpp"
#include "server/transfer/filters.hpp"

namespace kinship::fitting {

/// Outcome of one stored path.
struct PathOutcome {
  std::optional<KnownPath> path;  ///< none: it cannot be used
  bool was_known = false;         ///< from an earlier fit
  std::string problem;            ///< why it cannot
};

/// Transfers paths to one target, several at a time, which does not change the results.
class PathTransfer {
 public:
  /// \param store, key, target, prepared  outlive it.
  /// \param prepared  the target, for transfers.
  /// \param known     of an earlier fit of the same key; outlives it, may be null.
  /// \param threads   at least 1.
  PathTransfer(const store::ExperienceStore& store, const DistributionKey& key,
               const runtime::Robot& target, const transfer::TargetRobot& prepared,
               const KnownPaths* known, int threads);

  /// \param pair  of the paths' robot and the target.
  /// \param stop  checked throughout; then the remaining outcomes have neither path nor problem.
  /// \return      one per path, in their order. A bad path does not affect the others.
  std::vector<PathOutcome> transfer(std::span<const store::StoredPath> paths,
                                    const transfer::ArmPair& pair, const std::stop_token& stop);

 private:
  /// State of one thread: a collision world may be used by one thread at a time.
  struct Lane {
    transfer::ConfigurationFilter self;
    SceneFilters scenes;
  };
  /// A path in progress, and its known fields.
  struct Prepared {
    std::size_t index = 0;
    transfer::Filters filters;
    KnownPath known;
  };
  /// The paths of a call, and the next one to take.
  struct Queue {
    std::span<const store::StoredPath> paths;
    std::vector<std::size_t> unknown;  // indices of paths
    std::atomic<std::size_t> next = 0;
    std::vector<PathOutcome> outcomes;  // one per path, each written by one thread
  };
  class Share;

  Lane& lane(std::size_t index);
  const KnownPath* find_known(const store::StoredPath& stored) const;
  Prepared prepare(const store::StoredPath& stored, std::size_t index,
                   const transfer::ArmPair& pair, Lane& lane) const;

  const store::ExperienceStore& store_;
  const DistributionKey& key_;
  const runtime::Robot& target_;
  const transfer::TargetRobot& prepared_target_;
  const KnownPaths* const known_;
  std::vector<std::unique_ptr<Lane>> lanes_;  // made when they are first used
};

}  // namespace kinship::fitting
