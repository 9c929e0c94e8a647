#pragma once

#include <chrono>
#include <stop_token>

#include "proto/types/digest.hpp"
#include "server/store/distribution_store.hpp"

namespace kinship::catalog {

/// Holds the right to fit a distribution among all servers of a store, while it lives.
class FitTurn {
 public:
  /// Limits of the wait.
  struct Patience {
    std::chrono::milliseconds longest{60'000};
    std::chrono::milliseconds between_looks{100};  // the end of another server is not notified
  };

  /// Waits while another server has the right.
  /// \param store  outlives the turn.
  /// \throws Failure(Unavailable) if stopped, or if the other server takes longer; Failure(Storage)
  FitTurn(store::DistributionStore& store, const Digest& id, const std::stop_token& stop,
          const Patience& patience);
  FitTurn(store::DistributionStore& store, const Digest& id, const std::stop_token& stop)
      : FitTurn(store, id, stop, Patience{}) {}
  FitTurn(const FitTurn&) = delete;
  FitTurn& operator=(const FitTurn&) = delete;
  ~FitTurn() { store_.give_back_fit_right(id_, right_); }

  const store::FitRight& right() const noexcept { return right_; }
  /// Whether another server may have fitted it meanwhile.
  bool has_others() const noexcept { return right_.fence > 0; }

 private:
  store::DistributionStore& store_;
  const Digest id_;
  store::FitRight right_;
};

}  // namespace kinship::catalog
