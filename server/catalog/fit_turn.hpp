#pragma once

#include <chrono>
#include <stop_token>

#include "proto/types/digest.hpp"
#include "server/store/store.hpp"

namespace kinship::catalog {

/// The right to fit a distribution among all servers of a store, for as long as this lives.
class FitTurn {
 public:
  /// How long it is waited for.
  struct Patience {
    std::chrono::milliseconds longest{60'000};
    std::chrono::milliseconds between_looks{100};  // nobody tells that another server has ended
  };

  /// Waits while another server has it.
  /// \param store  outlives the turn.
  /// \throws Failure(Unavailable) if it was stopped, or the other one takes longer;
  ///         Failure(Storage)
  FitTurn(store::Store& store, const Digest& id, const std::stop_token& stop,
          const Patience& patience);
  FitTurn(store::Store& store, const Digest& id, const std::stop_token& stop)
      : FitTurn(store, id, stop, Patience{}) {}
  FitTurn(const FitTurn&) = delete;
  FitTurn& operator=(const FitTurn&) = delete;
  ~FitTurn() { store_.give_back_fit_right(id_, right_); }

  const store::FitRight& right() const noexcept { return right_; }
  /// Whether another server may have made it meanwhile.
  bool has_others() const noexcept { return right_.fence > 0; }

 private:
  store::Store& store_;
  const Digest id_;
  store::FitRight right_;
};

}  // namespace kinship::catalog
