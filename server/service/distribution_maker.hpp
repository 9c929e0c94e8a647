#pragma once

#include <functional>
#include <stop_token>

#include "server/service/fit_distribution.hpp"

namespace kinship::service {

/// Makes distributions and puts them into the store. May be shared between threads.
class DistributionMaker {
 public:
  using Fit = std::function<FitOutcome(const DistributionKey&, const std::stop_token&)>;

  struct Parts {
    store::Store& store;
    RobotRegistry& robots;
    const Clock& clock;
  };

  /// \param parts  outlive the maker.
  /// \param fit    empty: fit_distribution.
  DistributionMaker(const Parts& parts, Fit fit);

  /// A fit that threw becomes a failure with its reason, so that it is not tried for ever.
  /// \throws Failure(Storage or Unavailable), which may pass.
  FitOutcome make(const DistributionKey& key, const std::stop_token& stop) const;

  /// Whether its paths were retired while it was made. \throws Failure(Storage)
  bool is_outdated(const Distribution& distribution) const;

  /// Stores it and gives it its revision. If the store cannot take it, it is of use all the same
  /// while this server runs: with revision 0, and the reason says so.
  Distribution keep(Distribution distribution) const;

 private:
  const Parts parts_;
  const Fit fit_;
};

}  // namespace kinship::service
