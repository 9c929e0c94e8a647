#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "proto/codec/conversation.hpp"

namespace kinship::dds {

/// Requests that wait for the server: those of one client in order, clients in turn, so that who
/// sends many waits for his own. For sources of proto/dds only.
template <typename Request>
class FairQueue {
 public:
  explicit FairQueue(std::size_t capacity) : capacity_(capacity) {}

  std::size_t size() const noexcept { return size_; }

  bool has(const std::string& client, const codec::Head& head) const {
    const auto mine = waiting_.find(client);
    return mine != waiting_.end() && std::ranges::any_of(mine->second, [&](const auto& waits) {
             return waits.first == head;
           });
  }

  /// Whether admit() would take a request that does not wait yet: the queue is not full, or of
  /// somebody else more wait.
  bool has_room(const std::string& client) const {
    if (size_ < capacity_)
      return true;
    const auto mine = waiting_.find(client);
    const std::size_t count = mine == waiting_.end() ? 0 : mine->second.size();
    return std::ranges::any_of(waiting_,
                               [&](const auto& each) { return each.second.size() > count + 1; });
  }

  /// Makes room for a request if the queue is full: the newest of the client of whom most wait has
  /// to go, and is sent again.
  /// \param client  whose turn it is (Caller::client).
  /// \return false if this one has to go itself, or is waiting already.
  bool admit(const std::string& client, const codec::Head& head) {
    const auto mine = waiting_.find(client);
    const std::size_t count = mine == waiting_.end() ? 0 : mine->second.size();
    if (count > 0 &&
        std::ranges::any_of(mine->second, [&](const auto& waits) { return waits.first == head; }))
      return false;
    if (size_ < capacity_)
      return true;
    const auto longest =
        std::ranges::max_element(waiting_, {}, [](const auto& each) { return each.second.size(); });
    if (longest == waiting_.end() || longest->second.size() <= count + 1)
      return false;
    longest->second.pop_back();
    --size_;
    return true;
  }

  /// \pre admit() said so.
  void push(const std::string& client, const codec::Head& head, Request request) {
    auto& mine = waiting_[client];
    if (mine.empty())
      turns_.push_back(client);
    mine.emplace_back(head, std::move(request));
    ++size_;
  }

  std::optional<std::pair<codec::Head, Request>> pop() {
    if (turns_.empty())
      return std::nullopt;
    const auto next = waiting_.find(turns_.front());
    turns_.pop_front();
    std::optional<std::pair<codec::Head, Request>> request = std::move(next->second.front());
    next->second.pop_front();
    --size_;
    if (next->second.empty())
      waiting_.erase(next);
    else
      turns_.push_back(next->first);
    return request;
  }

 private:
  std::size_t capacity_;
  std::size_t size_ = 0;
  std::map<std::string, std::deque<std::pair<codec::Head, Request>>> waiting_;  // none is empty
  std::deque<std::string> turns_;  // each of these once
};

}  // namespace kinship::dds
