#include "server/catalog/advice_cache.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "server/catalog/advice_rule.hpp"

namespace kinship::catalog {
namespace {

constexpr int kMaxReadings = 3;               // of sums that attempts keep overtaking
constexpr std::size_t kMaxContexts = 10'000;  // clients may name any distributions

/// The distributions that attempts name, each once.
std::vector<Digest> distributions_of(const std::vector<store::KnownAttempt>& attempts) {
  std::set<Digest> distributions;
  for (const store::KnownAttempt& attempt : attempts)
    if (attempt.distribution_id)
      distributions.insert(*attempt.distribution_id);
  return {distributions.begin(), distributions.end()};
}

/// An attempt more.
void count(const AttemptCost& cost, store::AttemptTotals& totals) {
  const bool is_solved = cost.outcome == Outcome::Solved;
  const auto checks = static_cast<double>(cost.checks);
  store::ModeTotals& mode =
      cost.sampling_mode == SamplingMode::Guided ? totals.guided : totals.control;
  ++mode.attempts;
  mode.solved += is_solved ? 1 : 0;
  mode.checks += checks;
  mode.checks_squared += checks * checks;
  mode.checks_of_solved += is_solved ? checks : 0;
  if (cost.outcome == Outcome::Failed)
    return;
  add_newest(totals.recent, {.judged = {.sampling_mode = cost.sampling_mode,
                                        .solved = is_solved,
                                        .checks = cost.checks,
                                        .time_s = cost.time_s},
                             .planner = cost.planner,
                             .distribution_id = cost.distribution_id});
}

}  // namespace

AttemptCost cost_of(const Attempt& attempt) {
  return {attempt.task,
          attempt.robot,
          attempt.record.sampling_mode,
          attempt.record.outcome,
          attempt.record.collision_checks,
          attempt.record.planner,
          attempt.record.distribution_id,
          attempt.record.processor_time_s * attempt.record.machine_speed};
}

Advice AdviceCache::advise(const std::string& task, const Digest& robot, const Context& context,
                           double profile_share) {
  const Key key(task, robot);
  std::optional<store::AttemptTotals> totals;
  JudgedAttempts judged;
  bool begins = false;
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[key];
    entry.context = context;
    entry.profile_share = profile_share;
    if (entry.state == State::Read) {
      totals = entry.totals;
      judged = judged_attempts(context, contexts_, entry.totals.recent);
    }
    begins = entry.state == State::Unread;
    if (begins)
      entry.state = State::Reading;
  }
  if (totals)
    return catalog::advise(*totals, std::move(judged), profile_share);
  if (begins && !later_([this, key] { read_totals(key); }))
    end_reading(key, nullptr, true);  // the next request tries again
  Advice advice;
  advice.recommended_share = profile_share;
  advice.guided_share = profile_share;
  advice.evidence = "attempts are being counted: share of the profile";
  return advice;
}

std::uint64_t AdviceCache::version(const std::string& task, const Digest& robot) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find({task, robot});
  return found == entries_.end() ? 0 : found->second.version;
}

/// Keys whose attempts were read, in order.
std::vector<AdviceCache::Key> AdviceCache::keys_of_most_attempts(std::size_t max,
                                                                 std::size_t& left_out) const {
  std::vector<std::pair<std::uint64_t, Key>> known;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, entry] : entries_)
      if (entry.state == State::Read)
        known.emplace_back(entry.totals.guided.attempts + entry.totals.control.attempts, key);
  }
  left_out = known.size() - std::min(max, known.size());
  std::ranges::stable_sort(known, std::ranges::greater(),
                           [](const auto& pair) { return pair.first; });
  known.resize(std::min(max, known.size()));
  std::vector<Key> keys;
  for (auto& pair : known)
    keys.push_back(std::move(pair.second));
  std::ranges::sort(keys);
  return keys;
}

GuidanceWorths AdviceCache::worths(std::size_t max) const {
  GuidanceWorths worths;
  for (const Key& key : keys_of_most_attempts(max, worths.left_out)) {
    store::AttemptTotals totals;
    JudgedAttempts judged;
    double profile_share = 0;
    {
      const std::lock_guard lock(mutex_);
      const auto found = entries_.find(key);
      if (found == entries_.end())  // forgotten meanwhile
        continue;
      const Entry& entry = found->second;
      totals = entry.totals;
      judged = judged_attempts(entry.context, contexts_, entry.totals.recent);
      profile_share = entry.profile_share;
    }
    worths.pairs.push_back(
        {key.first, key.second, catalog::advise(totals, std::move(judged), profile_share)});
  }
  return worths;
}

void AdviceCache::add(const AttemptCost& cost) {
  if (cost.sampling_mode == SamplingMode::Uniform)
    return;
  const Key key(cost.task, cost.robot);
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end())
      return;
    found->second.is_overtaken = true;
    if (found->second.state != State::Read)
      return;
    count(cost, found->second.totals);
    ++found->second.version;
  }
  if (cost.distribution_id && !knows_context(*cost.distribution_id))
    later_([this, key, id = *cost.distribution_id] { find_contexts(key, {id}); });
}

void AdviceCache::read_again(const std::string& task, const Digest& robot) {
  const Key key(task, robot);
  {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end())
      return;
    found->second.is_overtaken = true;  // for a reading under way
    if (found->second.state != State::Read)
      return;
  }
  // Until then the sums of before are told. Two readings at a time do no harm.
  later_([this, key] { read_totals(key); });
}

void AdviceCache::forget(const Digest& robot) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&robot](const auto& entry) { return entry.first.second == robot; });
}

bool AdviceCache::knows_context(const Digest& distribution) const {
  const std::lock_guard lock(mutex_);
  return contexts_.contains(distribution);
}

void AdviceCache::find_contexts(const Key& key, const std::vector<Digest>& distributions) {
  for (const Digest& id : distributions) {
    if (knows_context(id))
      continue;
    std::optional<Context> found;
    try {
      found = find_context_(id);
    } catch (const std::exception&) {  // the next attempt that names it has it tried again
      continue;
    }
    const std::lock_guard lock(mutex_);
    if (contexts_.size() >= kMaxContexts)
      contexts_.clear();
    contexts_[id] = found.value_or(Context{});
    if (const auto entry = entries_.find(key); entry != entries_.end())
      ++entry->second.version;
  }
}

void AdviceCache::read_totals(const Key& key) {
  for (int reading = 1; reading <= kMaxReadings; ++reading) {
    {
      const std::lock_guard lock(mutex_);
      const auto found = entries_.find(key);
      if (found == entries_.end())  // its robot was removed meanwhile
        return;
      found->second.is_overtaken = false;
    }
    std::optional<store::AttemptTotals> totals;
    try {
      totals = read_(key.second, key.first);
    } catch (const std::exception&) {  // the next request tries again
    }
    if (totals)
      find_contexts(key, distributions_of(totals->recent));
    if (end_reading(key, totals ? &*totals : nullptr, reading == kMaxReadings))
      return;
  }
}

bool AdviceCache::end_reading(const Key& key, const store::AttemptTotals* totals,
                              bool is_last_try) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(key);
  if (found == entries_.end())  // its robot was removed meanwhile
    return true;
  Entry& entry = found->second;
  if (totals == nullptr) {
    entry.state = State::Unread;
    return true;
  }
  if (entry.is_overtaken && !is_last_try)
    return false;
  entry.totals = *totals;
  entry.state = State::Read;
  ++entry.version;
  return true;
}

}  // namespace kinship::catalog
