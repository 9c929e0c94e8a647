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

/// A reply on its way to one or many; shared by the catalog's memory and by those who send it.
using SharedReply = std::shared_ptr<const FetchReply>;
using FetchDone = std::function<void(const FetchReply&)>;

/// Answers to be given once no lock is held.
using Answers = std::vector<std::pair<FetchDone, SharedReply>>;
void give(const Answers& answers);

/// Whether a distribution is there that knows this generation of its robot's own experience.
bool satisfies(const FetchReply& reply, std::uint64_t minimum_generation);

/// Who sent a request: the name of a request is its client's and a number, with a space between.
inline std::string_view client_of(std::string_view request_key) {
  return request_key.substr(0, request_key.find(' '));
}

/// What one client may have so many of at a time.
enum class ClientBound { Waiters, Leases, Fits };

/// How many it has.
struct ClientHolds {
  std::size_t waiters = 0, leases = 0, fits = 0;
};

/// Somebody who waits for a distribution.
struct Waiter {
  /// The name of its request: a second waiter of the same one takes the place of the first.
  std::string key;
  std::uint64_t minimum_generation = 0;
  /// When it is told Pending. Empty: it takes what the store has.
  std::optional<std::chrono::steady_clock::time_point> deadline;
  FetchDone done;
};

/// One distribution being looked up or fitted, and who waits for it: however many ask, there is
/// one pending per id. Not shared between threads.
class PendingFit {
 public:
  enum class Stage {
    Idle,       ///< nobody works on it: its waiters ask for experience that has not arrived
    LookingUp,  ///< the store is being asked
    Queued,     ///< for a fit
    Fitting
  };

  explicit PendingFit(fitting::DistributionKey key) : key_(std::move(key)) {}

  const fitting::DistributionKey& key() const noexcept { return key_; }
  Stage stage = Stage::Idle;
  bool urgent = false;       ///< while Queued: before the background jobs
  bool is_wanted = false;    ///< somebody asked, and not a lease alone
  std::string client;        ///< who asked first; empty: nobody but a lease
  bool was_evicted = false;  ///< the distribution, since the look began or the fit was compared
  /// While Idle: its experience changed, but the short task pool had no room; when to try again.
  std::optional<std::chrono::steady_clock::time_point> look_up_due;

  /// A waiter that takes another's place keeps the earlier deadline of the two.
  void join(Waiter waiter);

  // Each of these adds an answer for those it lets go.
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
