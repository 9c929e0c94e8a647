#include "server/catalog/fit_turn.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>

#include "proto/types/failure.hpp"

namespace kinship::catalog {

FitTurn::FitTurn(store::DistributionStore& store, const Digest& id, const std::stop_token& stop,
                 const Patience& patience)
    : store_(store), id_(id) {
  const auto deadline = std::chrono::steady_clock::now() + patience.longest;
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::optional<store::FitRight> right = store_.take_fit_right(id_);
  while (!right) {
    if (stop.stop_requested())
      throw Failure(ErrorCode::Unavailable, "the server is stopping");
    if (std::chrono::steady_clock::now() >= deadline)
      throw Failure(ErrorCode::Unavailable, "another server fits it for longer than " +
                                                std::to_string(patience.longest.count()) + " ms");
    std::unique_lock lock(mutex);
    stopped.wait_for(lock, stop, patience.between_looks, [] { return false; });
    right = store_.take_fit_right(id_);
  }
  right_ = *right;
}

}  // namespace kinship::catalog
