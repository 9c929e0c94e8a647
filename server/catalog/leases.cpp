#include "server/catalog/leases.hpp"

#include <algorithm>
#include <iterator>

namespace kinship::catalog {

Comparison comparison_of(const Distribution& distribution, const ExperienceVersion& version,
                         bool behind) {
  return {.version = version, .behind = behind, .fitted_ms = distribution.fitted_ms};
}

void Leases::take(const Digest& id, const fitting::DistributionKey& key, TimePoint until) {
  if (Lease* const known = find(id)) {
    if (until <= known->until)
      return;
    by_end_.erase({known->until, id});
    known->until = until;
  } else {
    if (max_leases_ == 0)
      return;
    while (leases_.size() >= max_leases_)
      end(by_end_.begin()->second);
    Lease lease;
    lease.key = key;
    lease.until = until;
    leases_.emplace(id, std::move(lease));
    by_task_[key.task].insert(id);
  }
  by_end_.emplace(until, id);
  ended_.erase(id);
}

void Leases::end(Digest id) {
  const auto found = leases_.find(id);
  if (found == leases_.end())
    return;
  const Lease& lease = found->second;
  by_end_.erase({lease.until, id});
  if (lease.due)
    by_due_.erase({*lease.due, id});
  const auto task = by_task_.find(lease.key.task);
  task->second.erase(id);
  if (task->second.empty())
    by_task_.erase(task);
  leases_.erase(found);
  ended_.insert(id);
}

void Leases::end_all() {
  leases_.clear();
  by_end_.clear();
  by_due_.clear();
  by_task_.clear();
}

void Leases::expire(TimePoint now) {
  while (!by_end_.empty() && by_end_.begin()->first <= now)
    end(by_end_.begin()->second);
}

std::vector<Digest> Leases::take_ended() {
  const std::vector<Digest> ended(ended_.begin(), ended_.end());
  ended_.clear();
  return ended;
}

Leases::Lease* Leases::find(const Digest& id) {
  const auto found = leases_.find(id);
  return found == leases_.end() ? nullptr : &found->second;
}

bool Leases::holds(const Digest& id, TimePoint now) const {
  const auto found = leases_.find(id);
  return found != leases_.end() && found->second.until > now;
}

std::size_t Leases::count(TimePoint now) const {
  const auto ended = std::find_if(by_end_.begin(), by_end_.end(),
                                  [now](const auto& end) { return end.first > now; });
  return by_end_.size() - static_cast<std::size_t>(std::distance(by_end_.begin(), ended));
}

std::vector<Digest> Leases::of_task(std::string_view task) const {
  const auto found = by_task_.find(task);
  if (found == by_task_.end())
    return {};
  return {found->second.begin(), found->second.end()};
}

bool Leases::set_due(const Digest& id, std::optional<TimePoint> due) {
  const std::optional<TimePoint> before = next_due();
  Lease* const lease = find(id);
  if (lease == nullptr || lease->due == due)
    return false;
  if (lease->due)
    by_due_.erase({*lease->due, id});
  lease->due = due;
  if (due)
    by_due_.emplace(*due, id);
  return next_due() && (!before || *next_due() < *before);
}

std::optional<Leases::TimePoint> Leases::next_due() const {
  if (by_due_.empty())
    return std::nullopt;
  return by_due_.begin()->first;
}

std::vector<Digest> Leases::due(TimePoint now) const {
  std::vector<Digest> ids;
  for (const auto& [time, id] : by_due_) {
    if (time > now)
      break;
    ids.push_back(id);
  }
  return ids;
}

}  // namespace kinship::catalog
