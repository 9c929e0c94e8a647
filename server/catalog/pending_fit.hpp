#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/conversations.hpp"
#include "server/fitting/distribution_key.hpp"

namespace kinship::catalog {

/// A reply, shared by the catalog's memory and the answers being sent.
using SharedReply = std::shared_ptr<const FetchReply>;
using FetchDone = std::function<void(const FetchReply&)>;

/// Answers to be given without a lock.
using Answers = std::vector<std::pair<FetchDone, SharedReply>>;
void give(const Answers& answers);

/// Whether the reply has a distribution with this generation, or a later one, of its robot's own
/// experience.
bool satisfies(const FetchReply& reply, std::uint64_t minimum_generation);

/// The client of a request: the name of a request is the client's name, a space and a number.
inline std::string_view client_of(std::string_view request_key) {
  return request_key.substr(0, request_key.find(' '));
}

/// The resources that are limited per client.
enum class ClientBound { Waiters, Leases, Fits };

/// A client's use of them.
struct ClientHolds {
  std::size_t waiters = 0, leases = 0, fits = 0;
};

/// A fetch that waits for a distribution.
struct Waiter {
  /// The name of its request: a second waiter of the same request replaces the first.
  std::string key;
  std::uint64_t minimum_generation = 0;
  /// When it is answered Pending. Empty: it gets the distribution in the store, if any.
  std::optional<std::chrono::steady_clock::time_point> deadline;
  FetchDone done;
};

/// A distribution being looked up or fitted, and its waiters: one per id, for any number of
/// requests. Not shared between threads.
class PendingFit {
 public:
  enum class Stage {
    Idle,       ///< no work: its waiters want experience that has not arrived
    LookingUp,  ///< a look-up in the store is queued or running
    Queued,     ///< for a fit
    Fitting
  };

  explicit PendingFit(fitting::DistributionKey key) : key_(std::move(key)) {}

  const fitting::DistributionKey& key() const noexcept { return key_; }
  Stage stage = Stage::Idle;
  bool urgent = false;       ///< while Queued: ahead of background jobs
  bool is_wanted = false;    ///< a fetch asked, not only a lease
  std::string client;        ///< that asked first; empty: only a lease did
  bool was_evicted = false;  ///< the distribution, since the look-up began or the fit was compared
  /// While Idle: when to try a look-up again that the short task pool had no room for.
  std::optional<std::chrono::steady_clock::time_point> look_up_due;

  /// Adds a waiter; one that replaces another keeps the earlier deadline of the two.
  void join(Waiter waiter);

  // Each of these removes waiters and adds their answers.
  void answer_all(const SharedReply& reply, Answers& answers);
  void answer_satisfied(const SharedReply& reply, Answers& answers);
  void answer_without_deadline(const SharedReply& reply, Answers& answers);
  void answer_expired(std::chrono::steady_clock::time_point now, const SharedReply& reply,
                      Answers& answers);

  const std::vector<Waiter>& waiters() const noexcept { return waiters_; }

 private:
  template <typename Predicate>
  void answer_if(Predicate predicate, const SharedReply& reply, Answers& answers);

  fitting::DistributionKey key_;
  std::vector<Waiter> waiters_;
};

}  // namespace kinship::catalog
