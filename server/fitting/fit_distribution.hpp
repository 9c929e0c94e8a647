#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "proto/types/distribution.hpp"
#include "server/fitting/distribution_key.hpp"
#include "server/fitting/fit_memory.hpp"
#include "server/fitting/memory_ceiling.hpp"
#include "server/fitting/target_memory.hpp"
#include "server/runtime/clock.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::fitting {

/// Inputs of a fit and their limits.
struct FitContext {
  const store::ExperienceStore& store;
  runtime::RobotRegistry& robots;
  const runtime::Clock& clock;
  /// Paths of all sources together. If they have more, each source contributes its share
  /// (share_paths), spread evenly over the order of arrival, and the distribution's reason says so.
  std::size_t max_paths = 4000;
  int fit_threads = 1;  ///< of one fit and its transfer; the result does not depend on it
  /// State of the last fit of the same distribution: its paths are not transferred again, and the
  /// fit may start from its mixture (warm_refit.hpp). Null: a full fit.
  FitMemory::State before = nullptr;
  /// Paths that are not used, by their report; empty: all are used. The distribution does not say
  /// what was left out: it is for comparisons.
  std::function<bool(const Uuid& report)> leaves_out = {};
  MemoryCeiling* memory = nullptr;  ///< of all fits together; null: there is no limit
  TargetMemory* targets = nullptr;  ///< prepared target robots; null: each fit prepares its own
};

/// A distribution is thin if a smaller share of its sources' poses was solved, each source weighted
/// by its mass.
inline constexpr double kThinShare = 0.2;

struct FitOutcome {
  enum class Kind { Fitted, NoExperience, Abandoned };
  Kind kind = Kind::NoExperience;
  std::optional<Distribution> distribution;  ///< present exactly if Fitted; its state may be Failed
  /// For the next fit, if Fitted; the caller sets the revision of the mixture once it is stored.
  std::shared_ptr<WarmState> warm_state = nullptr;
};

/// Reads the selected experience of a task, transfers it to the target robot and fits a mixture.
/// The revision is left 0. Paths and robots that cannot be used are left out, and the reason says
/// so. Equal store content, key and `before`: equal distribution, except for the times; without
/// `before` its mixture is that of any other full fit.
/// \param stop  checked throughout; a stopped fit is Abandoned.
/// \throws Failure(NotFound or InvalidInput) for the target robot; Failure(Storage);
///         Failure(TooLarge), before a path is transferred, if the fit could need more memory than
///         the limit.
/// Source: Lehner et al., ICRA 2022, section IV.
FitOutcome fit_distribution(const DistributionKey& key, const FitContext& context,
                            const std::stop_token& stop);

/// The record of a fit that ended without a distribution: Failed with this reason, cut to
/// kMaxMessageBytes, and with the current experience as its sources.
/// \throws Failure(NotFound or InvalidInput) for the target robot; Failure(Storage).
Distribution failed_distribution(const DistributionKey& key, const FitContext& context,
                                 const std::string& reason);

}  // namespace kinship::fitting
