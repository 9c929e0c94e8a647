#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/advice.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "server/catalog/judged_attempts.hpp"
#include "server/store/experience_store.hpp"

namespace kinship::catalog {

/// The cost of planning in a report.
struct AttemptCost {
  std::string task;
  Digest robot;
  SamplingMode sampling_mode = SamplingMode::Uniform;
  Outcome outcome = Outcome::Failed;
  std::uint64_t checks = 0;
  std::string planner = {};
  std::optional<Digest> distribution_id = {};
  double time_s = 0;  ///< see JudgedAttempt
};

AttemptCost cost_of(const Attempt& attempt);

/// The advice from the attempts of a robot and task, for the context last requested.
struct GuidanceWorth {
  std::string task;
  Digest robot;
  Advice advice;
};

/// Advice for the pairs with most attempts, in order of tasks and robots.
struct GuidanceWorths {
  std::vector<GuidanceWorth> pairs;
  std::size_t left_out = 0;  ///< further pairs
};

/// Caches the advice from the attempts of each requested (task, robot). The sums are read from the
/// store once, in the background, and then updated with each committed attempt. May be shared
/// between threads; advise() never waits for the store.
///
/// If attempts are committed while the sums are read, the sums are read again, a few times; after
/// that an attempt of that moment may count twice or not at all, until the next start.
///
/// Distributions of attempts are looked up in the background, once; until then their context is
/// unknown.
class AdviceCache {
 public:
  /// Reads the sums from the store; may throw.
  using Read = std::function<store::AttemptTotals(const Digest& robot, const std::string& task)>;
  /// The context of a distribution; nothing if it is unknown. May throw.
  using FindContext = std::function<std::optional<Context>(const Digest& distribution_id)>;
  /// Queues a function for another thread. \return false if there is no room for it.
  using Later = std::function<bool(std::function<void()>)>;

  AdviceCache(Read read, FindContext find_context, Later later)
      : read_(std::move(read)), find_context_(std::move(find_context)), later_(std::move(later)) {}
  AdviceCache(const AdviceCache&) = delete;
  AdviceCache& operator=(const AdviceCache&) = delete;

  /// The current advice (advice_rule.hpp) for guidance of a context. Until the store has answered:
  /// `profile_share`; the first call has the sums read.
  Advice advise(const std::string& task, const Digest& robot, const Context& context,
                double profile_share);

  /// Grows whenever the result of advise() may change; 0: the sums are not read yet.
  std::uint64_t version(const std::string& task, const Digest& robot) const;

  /// The current advice for at most `max` requested (task, robot) pairs. Holds the lock for one
  /// pair at a time; too slow for a fetch.
  GuidanceWorths worths(std::size_t max) const;

  /// Adds a committed attempt, Stored or Recorded.
  void add(const AttemptCost& cost);

  /// Another server committed attempts: the sums are read again, in the background, if they are
  /// known.
  void read_again(const std::string& task, const Digest& robot);

  /// Forgets a removed robot, until the next request for it.
  void forget(const Digest& robot);

 private:
  enum class State { Unread, Reading, Read };
  struct Entry {
    State state = State::Unread;
    bool is_overtaken = false;  // something was committed since the reading began
    std::uint64_t version = 0;
    store::AttemptTotals totals;
    Context context;  // last asked for, and its profile's share
    double profile_share = 0;
  };
  using Key = std::pair<std::string, Digest>;

  std::vector<Key> keys_of_most_attempts(std::size_t max, std::size_t& left_out) const;
  void read_totals(const Key& key);
  bool end_reading(const Key& key, const store::AttemptTotals* totals, bool is_last_try);
  void find_contexts(const Key& key, const std::vector<Digest>& distributions);
  bool knows_context(const Digest& distribution) const;

  const Read read_;
  const FindContext find_context_;
  const Later later_;
  mutable std::mutex mutex_;  // guards what follows
  std::map<Key, Entry> entries_;
  Contexts contexts_;
};

}  // namespace kinship::catalog
