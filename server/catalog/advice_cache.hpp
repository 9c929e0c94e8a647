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
#include "server/store/store.hpp"

namespace kinship::catalog {

/// What a report says about the cost of planning.
struct AttemptCost {
  std::string task;
  Digest robot;
  SamplingMode sampling_mode = SamplingMode::Uniform;
  Outcome outcome = Outcome::Failed;
  std::uint64_t checks = 0;
  std::string planner = {};
  std::optional<Digest> distribution_id = {};
};

AttemptCost cost_of(const Attempt& attempt);

/// What the attempts of a robot and task say about guidance by the context last asked for.
struct GuidanceWorth {
  std::string task;
  Digest robot;
  Advice advice;
};

/// Of the pairs with most attempts, in the order of their tasks and robots.
struct GuidanceWorths {
  std::vector<GuidanceWorth> pairs;
  std::size_t left_out = 0;  ///< pairs beyond those
};

/// Knows what the attempts of each (task, robot) that somebody asked for recommend. The sums are
/// read from the store once, in the background, and then kept up with what is committed. May be
/// shared between threads; asking never waits for the store.
///
/// Attempts that are committed while the sums are read have them read again, a few times; an
/// attempt of that moment may in the end count twice or not at all, until the next start.
///
/// Distributions that attempts name are looked up in the background, once; until then they are of
/// an unknown context.
class AdviceCache {
 public:
  /// Reads the sums from the store; may throw.
  using Read = std::function<store::AttemptTotals(const Digest& robot, const std::string& task)>;
  /// What made a distribution; nothing if nobody knows it. May throw.
  using FindContext = std::function<std::optional<Context>(const Digest& distribution_id)>;
  /// Has a function called soon on another thread. \return false if there is no room for it.
  using Later = std::function<bool(std::function<void()>)>;

  AdviceCache(Read read, FindContext find_context, Later later)
      : read_(std::move(read)), find_context_(std::move(find_context)), later_(std::move(later)) {}
  AdviceCache(const AdviceCache&) = delete;
  AdviceCache& operator=(const AdviceCache&) = delete;

  /// The advice of now (advice_rule.hpp) for guidance of a context. The first time, and as long as
  /// the store has not answered: `profile_share`, and the sums are read.
  Advice advise(const std::string& task, const Digest& robot, const Context& context,
                double profile_share);

  /// Grows whenever advise() may say something else than before; 0: nothing is known yet.
  std::uint64_t version(const std::string& task, const Digest& robot) const;

  /// What is advised now, of at most `max` of the (task, robot) that somebody asked for. Holds the
  /// lock for one pair at a time; not for the path of a fetch.
  GuidanceWorths worths(std::size_t max) const;

  /// An attempt was committed, Stored or Recorded.
  void add(const AttemptCost& cost);

  /// Somebody else committed attempts: the sums are read anew, in the background, if they are
  /// known.
  void read_again(const std::string& task, const Digest& robot);

  /// A robot was removed: nothing is known of it until somebody asks for it again.
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
