#include "server/catalog/leases.hpp"

#include <algorithm>
#include <iterator>

namespace kinship::catalog {

Comparison comparison_of(const Distribution& distribution, const ExperienceVersion& version,
                         bool behind) {
  return {.version = version, .behind = behind, .fitted_ms = distribution.fitted_ms};
}

bool Leases::take(const Digest& id, const fitting::DistributionKey& key, TimePoint until,
                  const std::string& client) {
  if (max_holds_ == 0)
    return true;
  Lease* lease = find(id);
  const auto own =
      lease == nullptr ? std::map<std::string, TimePoint>::iterator{} : lease->holders.find(client);
  const bool has_one = lease != nullptr && own != lease->holders.end();
  if (has_one && until <= own->second)
    return true;
  if (has_one) {
    drop(id, client);
  } else {
    if (max_per_client_ > 0 && !client.empty() && count_of(client) >= max_per_client_)
      return false;
    while (holds_ >= max_holds_)
      make_room(client);
  }
  lease = find(id);
  if (lease == nullptr) {
    leases_[id].key = key;
    by_task_[key.task].insert(id);
  }
  hold(id, until, client);
  ended_.erase(id);
  return true;
}

void Leases::hold(const Digest& id, TimePoint until, const std::string& client) {
  Lease& lease = leases_.at(id);
  lease.holders[client] = until;
  set_until(id, lease);
  ends_.emplace(until, id, client);
  clients_[client].by_end.emplace(until, id);
  ++holds_;
  weigh(client);
}

/// Takes a hold away; the lease stays, also without any.
void Leases::drop(const Digest& id, const std::string& client) {
  Lease& lease = leases_.at(id);
  const TimePoint until = lease.holders.at(client);
  lease.holders.erase(client);
  ends_.erase({until, id, client});
  clients_.at(client).by_end.erase({until, id});
  --holds_;
  weigh(client);
  set_until(id, lease);
}

void Leases::set_until(const Digest& id, Lease& lease) {
  by_end_.erase({lease.until, id});
  if (lease.holders.empty())
    return;
  lease.until = std::ranges::max_element(lease.holders, {}, [](const auto& holder) {
                  return holder.second;
                })->second;
  by_end_.emplace(lease.until, id);
}

/// The client with the most holds, counting the one asked for, loses the hold that ends first.
void Leases::make_room(const std::string& client) {
  const Load& heaviest = *loads_.rbegin();
  const bool is_own = count_of(client) + 1 > std::get<std::size_t>(heaviest);
  const std::string loser = is_own ? client : std::get<std::string>(heaviest);
  const Digest id = clients_.at(loser).by_end.begin()->second;
  drop(id, loser);
  if (leases_.at(id).holders.empty())
    forget(id);
}

void Leases::weigh(const std::string& client) {
  const auto found = clients_.find(client);
  Client& own = found->second;
  loads_.erase(own.load);
  if (own.by_end.empty()) {
    clients_.erase(found);
    return;
  }
  own.load = {own.by_end.size(), -own.by_end.begin()->first.time_since_epoch(), client};
  loads_.insert(own.load);
}

std::size_t Leases::count_of(const std::string& client) const {
  const auto found = clients_.find(client);
  return found == clients_.end() ? 0 : found->second.by_end.size();
}

void Leases::end(Digest id) {
  const auto found = leases_.find(id);
  if (found == leases_.end())
    return;
  while (!found->second.holders.empty())
    drop(id, std::string(found->second.holders.begin()->first));
  forget(id);
}

/// \pre it has no holder any more.
void Leases::forget(const Digest& id) {
  const auto found = leases_.find(id);
  const Lease& lease = found->second;
  if (lease.due)
    by_due_.erase({*lease.due, id});
  const auto task = by_task_.find(lease.key.task);
  task->second.erase(id);
  if (task->second.empty())
    by_task_.erase(task);
  ended_.insert(id);
  leases_.erase(found);
}

void Leases::end_all() {
  leases_.clear();
  clients_.clear();
  loads_.clear();
  ends_.clear();
  by_end_.clear();
  by_due_.clear();
  by_task_.clear();
  holds_ = 0;
}

void Leases::expire(TimePoint now) {
  while (!ends_.empty() && std::get<TimePoint>(*ends_.begin()) <= now) {
    const auto [until, id, client] = *ends_.begin();
    drop(id, client);
    if (leases_.at(id).holders.empty())
      forget(id);
  }
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

void Leases::add_to(std::map<std::string, ClientHolds>& holds) const {
  for (const auto& [name, client] : clients_)
    if (!name.empty())
      holds[name].leases += client.by_end.size();
}

std::vector<Digest> Leases::of_task(std::string_view task) const {
  const auto found = by_task_.find(task);
  if (found == by_task_.end())
    return {};
  return {found->second.begin(), found->second.end()};
}

std::vector<Digest> Leases::of_robot(const Digest& robot) const {
  std::vector<Digest> ids;
  for (const auto& [id, lease] : leases_)
    if (lease.key.robot == robot)
      ids.push_back(id);
  return ids;
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
