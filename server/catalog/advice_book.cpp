#include "server/catalog/advice_book.hpp"

#include <optional>
#include <utility>

#include "proto/evidence/attempt_window.hpp"
#include "server/catalog/advice_rule.hpp"

namespace kinship::catalog {
namespace {

constexpr int kMaxReadings = 3;  // of sums that attempts keep overtaking

}  // namespace

AttemptCost cost_of(const Attempt& attempt) {
  return {attempt.task, attempt.robot, attempt.record.sampling_mode, attempt.record.outcome,
          attempt.record.collision_checks};
}

Advice AdviceBook::advise(const std::string& task, const Digest& robot, double profile_share) {
  const Key key(task, robot);
  std::optional<store::AttemptTotals> totals;
  bool begins = false;
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[key];
    if (entry.state == State::Read)
      totals = entry.totals;
    begins = entry.state == State::Unread;
    if (begins)
      entry.state = State::Reading;
  }
  if (totals)
    return catalog::advise(*totals, profile_share);
  if (begins && !later_([this, key] { read_totals(key); }))
    end_reading(key, nullptr, true);  // whoever asks next has it tried again
  Advice advice;
  advice.recommended_share = profile_share;
  advice.guided_share = profile_share;
  advice.evidence = "attempts are being counted: share of the profile";
  return advice;
}

std::uint64_t AdviceBook::version(const std::string& task, const Digest& robot) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find({task, robot});
  return found == entries_.end() ? 0 : found->second.version;
}

void AdviceBook::add(const AttemptCost& cost) {
  if (cost.sampling_mode == SamplingMode::Uniform)
    return;
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find({cost.task, cost.robot});
  if (found == entries_.end())
    return;
  Entry& entry = found->second;
  entry.is_overtaken = true;
  if (entry.state != State::Read)
    return;
  store::ModeTotals& mode =
      cost.sampling_mode == SamplingMode::Guided ? entry.totals.guided : entry.totals.control;
  const auto checks = static_cast<double>(cost.checks);
  ++mode.attempts;
  const bool solved = cost.outcome == Outcome::Solved;
  mode.solved += solved ? 1 : 0;
  mode.checks += checks;
  mode.checks_squared += checks * checks;
  mode.checks_of_solved += solved ? checks : 0;
  if (cost.outcome != Outcome::Failed) {
    evidence::AttemptWindow window(std::move(entry.totals.recent));
    window.add(cost.sampling_mode, solved, cost.checks);
    entry.totals.recent = window.recent();
  }
  ++entry.version;
}

void AdviceBook::read_totals(const Key& key) {
  for (int reading = 1; reading <= kMaxReadings; ++reading) {
    {
      const std::lock_guard lock(mutex_);
      entries_[key].is_overtaken = false;
    }
    std::optional<store::AttemptTotals> totals;
    try {
      totals = read_(key.second, key.first);
    } catch (const std::exception&) {  // whoever asks next has it tried again
    }
    if (end_reading(key, totals ? &*totals : nullptr, reading == kMaxReadings))
      return;
  }
}

bool AdviceBook::end_reading(const Key& key, const store::AttemptTotals* totals, bool is_last_try) {
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[key];
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
