#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>

#include "proto/types/distribution.hpp"
#include "server/service/clock.hpp"
#include "server/service/distribution_key.hpp"
#include "server/service/robot_registry.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// What a fit reads, and how much of it.
struct FitContext {
  const store::Store& store;
  RobotRegistry& robots;
  const Clock& clock;
  /// Of all sources together. From more than that each source contributes its share (share_paths),
  /// evenly over the order of arrival, and the distribution's reason says so.
  std::size_t max_paths = 4000;
  int fit_threads = 1;  ///< of one fit of a mixture; the result does not depend on them
};

/// A distribution is thin if fewer of its sources' poses were solved, each source counted by its
/// mass.
inline constexpr double kThinShare = 0.2;

struct FitOutcome {
  enum class Kind { Fitted, NoExperience, Abandoned };
  Kind kind = Kind::NoExperience;
  std::optional<Distribution> distribution;  ///< present exactly if Fitted; its state may be Failed
};

/// Reads the selected experience of a task, transfers it to the target robot and fits a mixture.
/// The revision is left 0. Paths and robots that cannot be used are left out, and the reason says
/// so. Equal store content and key: equal distribution, but for the times. \param stop  looked at
/// between paths: Abandoned. \throws Failure(NotFound or InvalidInput) for the target robot;
/// Failure(Storage). Source: Lehner et al., ICRA 2022, section IV.
FitOutcome fit_distribution(const DistributionKey& key, const FitContext& context,
                            const std::stop_token& stop);

/// The record of a fit that ended without one: Failed with this reason, cut to what a message may
/// have, and with the experience of now as its sources.
/// \throws Failure(NotFound or InvalidInput) for the target robot; Failure(Storage).
Distribution failed_distribution(const DistributionKey& key, const FitContext& context,
                                 const std::string& reason);

}  // namespace kinship::service
