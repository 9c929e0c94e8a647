#include "server/catalog/experience_index.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace kinship::catalog {
namespace {

constexpr std::size_t kMaxQueuedChoices = 256;

/// About the memory of a choice, shared with others or not.
std::size_t size_of(const SharedChoice& choice) {
  std::size_t bytes = 0;
  if (choice)
    for (const fitting::SharedPosePath& path : choice->paths)
      bytes += sizeof(PosePath) + path->poses.capacity() * sizeof(Eigen::Isometry3d);
  return bytes;
}

}  // namespace

ExperienceIndex::ExperienceIndex(const store::ExperienceStore& store,
                                 runtime::RobotRegistry& robots, const Limits& limits)
    : limits_(limits),
      memory_(store, robots, limits.paths),
      pool_({.threads = 1, .queue_limit = kMaxQueuedChoices, .niceness = 0}) {}

SharedChoice ExperienceIndex::find(const ExperienceKey& key) {
  const std::lock_guard lock(mutex_);
  return find_current(key);
}

SharedChoice ExperienceIndex::find_current(const ExperienceKey& key) {
  const auto found = entries_.find(key);
  if (found == entries_.end() || !found->second.choice ||
      found->second.chosen_at != versions_.of(key.task).changes)
    return nullptr;
  found->second.last_used = ++uses_;
  return found->second.choice;
}

void ExperienceIndex::ask(const ExperienceKey& key, Done done) {
  SharedChoice choice;
  {
    const std::lock_guard lock(mutex_);
    choice = is_stopping_ ? nullptr : find_current(key);
    if (!choice && !is_stopping_ && waiters_ < limits_.max_waiters) {
      Entry& entry = entries_[key];
      entry.last_used = ++uses_;
      if (!entry.is_working)
        entry.is_working = submit(key);
      if (entry.is_working) {
        entry.waiters.push_back({versions_.of(key.task).changes, std::move(done)});
        ++waiters_;
        return;
      }
      make_room();
    }
  }
  done(choice);
}

bool ExperienceIndex::submit(const ExperienceKey& key) {
  return pool_.submit(runtime::WorkerPool::Priority::Interactive,
                      {.run = [this, key] { choose(key); }, .abandon = {}});
}

void ExperienceIndex::new_experience(std::string_view task) {
  const std::lock_guard lock(mutex_);
  versions_.grew(task);
}

void ExperienceIndex::forget(std::string_view task) {
  const std::lock_guard lock(mutex_);
  versions_.lost(task);
}

void ExperienceIndex::choose(const ExperienceKey& key) {
  std::uint64_t chosen_at = 0;
  {
    const std::lock_guard lock(mutex_);
    chosen_at = versions_.of(key.task).changes;
  }
  SharedChoice choice;
  const std::stop_token stop = stop_source_.get_token();
  try {
    choice = std::make_shared<const fitting::ExperienceChoice>(fitting::choose_experience(
        memory_.read(key.task, key.sources, key.since_ms, stop), key.bytes));
  } catch (const std::exception&) {  // the store cannot be read: the next request tries again
    choice = nullptr;
  }
  if (stop.stop_requested())
    choice = nullptr;  // incomplete
  for (const auto& [done, answer] : complete(key, choice, chosen_at))
    done(answer);
}

/// Keeps the choice. It answers requests from before it was begun, later ones wait for another.
ExperienceIndex::ChoiceAnswers ExperienceIndex::complete(const ExperienceKey& key,
                                                         const SharedChoice& choice,
                                                         std::uint64_t chosen_at) {
  ChoiceAnswers answers;
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[key];
  if (choice) {
    entry.choice = choice;
    entry.chosen_at = chosen_at;
    let_go(entry, chosen_at, choice, answers);
  }
  entry.is_working = choice && !entry.waiters.empty() && submit(key);
  if (!entry.is_working)
    let_go(entry, versions_.of(key.task).changes, nullptr, answers);
  make_room();
  return answers;
}

/// Answers the requests made at that state of the experience or before.
void ExperienceIndex::let_go(Entry& entry, std::uint64_t chosen_at, const SharedChoice& choice,
                             ChoiceAnswers& answers) {
  const auto later =
      std::stable_partition(entry.waiters.begin(), entry.waiters.end(),
                            [&](const Waiter& waiter) { return waiter.asked_at <= chosen_at; });
  waiters_ -= static_cast<std::size_t>(later - entry.waiters.begin());
  for (auto waiter = entry.waiters.begin(); waiter != later; ++waiter)
    answers.emplace_back(std::move(waiter->done), choice);
  entry.waiters.erase(entry.waiters.begin(), later);
}

/// Forgets choices that were not asked for longest.
void ExperienceIndex::make_room() {
  std::size_t bytes = 0;
  for (const auto& [key, entry] : entries_)
    bytes += size_of(entry.choice);
  while (entries_.size() > limits_.max_choices ||
         (bytes > limits_.paths.bytes && entries_.size() > 1)) {
    auto oldest = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry)
      if (!entry->second.is_working &&
          (oldest == entries_.end() || entry->second.last_used < oldest->second.last_used))
        oldest = entry;
    if (oldest == entries_.end())
      return;
    bytes -= size_of(oldest->second.choice);
    entries_.erase(oldest);
  }
}

void ExperienceIndex::stop() {
  ChoiceAnswers waiting;
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    for (auto& [key, entry] : entries_)
      let_go(entry, versions_.of(key.task).changes, nullptr, waiting);
  }
  stop_source_.request_stop();
  for (const auto& [done, nothing] : waiting)
    done(nothing);
  pool_.stop(runtime::WorkerPool::Leftovers::Abandon);
}

}  // namespace kinship::catalog
