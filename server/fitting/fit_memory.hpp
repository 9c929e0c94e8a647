#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/mixture.hpp"
#include "server/fitting/branch_cuts.hpp"
#include "server/fitting/known_paths.hpp"
#include "server/fitting/last_used.hpp"

namespace kinship::fitting {

/// The last full fit of a distribution, against which growth is measured.
struct FullFit {
  std::uint64_t revision = 0;
  std::uint64_t paths = 0;     ///< used
  std::vector<double> masses;  ///< of the sources, in their order
  std::optional<double> held_out_score;
  std::vector<ComponentScore> component_scores;
  Eigen::MatrixXd prior_scatter = {};  ///< added to the covariances; empty: none
};

/// State that a fit keeps for the next fit of the same distribution.
struct WarmState {
  KnownPaths paths;                ///< it used
  std::vector<Digest> sources;     ///< of which it used a path, ascending
  std::optional<Mixture> mixture;  ///< none: the next fit is a full one
  std::uint64_t revision = 0;      ///< of that mixture
  BranchCuts cuts;                 ///< it was fitted with
  FullFit full;                    ///< this fit, or the last full one before it
};

/// Cache of the states of fits, by distribution, bounded by size: evicts the least recently used.
/// In memory only: after a restart the server makes full fits. May be shared between threads.
class FitMemory {
 public:
  using State = std::shared_ptr<const WarmState>;

  /// About 15 distributions of 4000 paths each, or 300 of 500 paths.
  static constexpr std::size_t kDefaultBytes = std::size_t{256} << 20U;

  explicit FitMemory(std::size_t max_bytes = kDefaultBytes) : max_bytes_(max_bytes) {}

  State find(const Digest& id);  ///< null if there is none; counts as a use

  /// Replaces the state of this distribution. A state above the limit is not kept.
  void put(const Digest& id, State warm_state);

  void erase(const Digest& id);

  std::size_t bytes() const;  ///< of the configurations, about

 private:
  const std::size_t max_bytes_;
  mutable std::mutex mutex_;  // guards what follows
  LastUsed<State> states_;
};

}  // namespace kinship::fitting
