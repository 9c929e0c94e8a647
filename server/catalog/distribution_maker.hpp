#pragma once

#include <chrono>
#include <functional>
#include <stop_token>

#include "server/fitting/fit_distribution.hpp"
#include "server/store/distribution_store.hpp"

namespace kinship::catalog {

/// Makes distributions and puts them into the store. May be shared between threads.
class DistributionMaker {
 public:
  using Fit =
      std::function<fitting::FitOutcome(const fitting::DistributionKey&, const std::stop_token&)>;

  struct Parts {
    const store::ExperienceStore& store;
    store::DistributionStore& distributions;
    runtime::RobotRegistry& robots;
    const runtime::Clock& clock;
    fitting::MemoryCeiling* memory = nullptr;  ///< of all fits together; null: no limit
  };

  /// \param parts  outlive the maker.
  /// \param fit    empty: fit_distribution.
  DistributionMaker(const Parts& parts, Fit fit);

  DistributionMaker(const DistributionMaker&) = delete;
  DistributionMaker& operator=(const DistributionMaker&) = delete;

  /// A fit that threw becomes a failure with its reason, so that it is not tried for ever.
  /// \throws Failure(Storage), Failure(Unavailable) for want of memory or threads, which may pass;
  ///         Failure(TooLarge) if it would exceed the memory limit. These tell nothing about the
  ///         experience and replace no distribution.
  fitting::FitOutcome make(const fitting::DistributionKey& key, const std::stop_token& stop) const;

  /// Whether paths of a distribution were retired while it was made. \throws Failure(Storage)
  bool is_outdated(const Distribution& distribution) const;

  /// Stores a distribution, gives it its revision and keeps its state for the next fit. If the
  /// store cannot take it, this server still serves it, with revision 0 and the reason; then the
  /// next fit is a full one.
  /// \param right    the store's right to fit it. \throws Failure(Unavailable) if another server
  ///                 has it since.
  /// \param outcome  with a distribution. One with a date evicts others of its task and robot with
  ///                 dates that were not fitted for kDatedAge: daily requests for the last two
  ///                 weeks each name another distribution.
  Distribution keep(fitting::FitOutcome outcome, const store::FitRight& right) const;
  static constexpr std::chrono::hours kDatedAge{7 * 24};

  /// The next fit of this distribution begins anew.
  void forget(const Digest& id) const { memory_.erase(id); }
  std::size_t memory_bytes() const { return memory_.bytes(); }  ///< of states kept by fits, about

 private:
  void evict_old_dated(const Distribution& kept) const;
  void remember(const Distribution& distribution,
                std::shared_ptr<fitting::WarmState> warm_state) const;

  const Parts parts_;
  mutable fitting::FitMemory memory_;
  mutable fitting::TargetMemory targets_;
  const Fit fit_;
};

}  // namespace kinship::catalog
