#include "server/ros2/follows.hpp"

#include <cmath>

namespace kinship::ros2 {
namespace {

std::string name_of(const FetchRequest& query) {
  constexpr double kPerUnit = 1e6;
  std::string name = query.task + ' ' + query.robot.hex() + ' ' + query.profile;
  if (query.T_task_base)
    for (const double number : query.T_task_base->matrix().topRows<3>().reshaped())
      name += ' ' + std::to_string(std::llround(kPerUnit * number));
  return name;
}

}  // namespace

bool Follows::keep(const std::string& client, const FetchRequest& query, TimePoint now) {
  Follow follow{client, query};
  follow.query.follow = std::chrono::seconds(0);
  follow.query.deadline = std::chrono::milliseconds(0);
  const Entry entry{std::move(follow), now + query.follow};
  const std::lock_guard lock(mutex_);
  forget_ended(now);
  const Key key{client, name_of(query)};
  if (const auto known = entries_.find(key); known != entries_.end()) {
    known->second = entry;
    return true;
  }
  std::size_t& count = of_client_[client];
  if (entries_.size() >= kMax || count >= kMaxOfClient)
    return false;
  entries_.emplace(key, entry);
  ++count;
  return true;
}

std::vector<Follows::Follow> Follows::of(const Announcement& announcement, TimePoint now) {
  const std::lock_guard lock(mutex_);
  forget_ended(now);
  std::vector<Follow> follows;
  for (const auto& [key, entry] : entries_)
    if (entry.follow.query.task == announcement.task &&
        entry.follow.query.robot == announcement.robot)
      follows.push_back(entry.follow);
  return follows;
}

void Follows::keep_only(const std::set<std::string>& clients) {
  const std::lock_guard lock(mutex_);
  forget_if([&](const Entry& each) { return !clients.contains(each.follow.client); });
}

bool Follows::empty() const {
  const std::lock_guard lock(mutex_);
  return entries_.empty();
}

void Follows::forget_ended(TimePoint now) {
  forget_if([&](const Entry& each) { return each.end <= now; });
}

template <typename Is>
void Follows::forget_if(const Is& is) {
  std::erase_if(entries_, [&](const auto& each) {
    if (!is(each.second))
      return false;
    const auto count = of_client_.find(each.first.first);
    if (--count->second == 0)
      of_client_.erase(count);
    return true;
  });
}

}  // namespace kinship::ros2
