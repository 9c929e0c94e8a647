#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "proto/codec/conversation.hpp"

namespace kinship::dds {

/// Requests that wait for the server: those of one client in order, clients in turn, so that a
/// client that sends many delays only itself. A request may be held: it waits like all others, and
/// is skipped until its time has come or it is released. For sources of proto/dds only.
template <typename Request>
class FairQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr Time kNow = Time::min();  ///< as `held_until`: not held
  static constexpr Time kNever = Time::max();

  explicit FairQueue(std::size_t capacity) : capacity_(capacity) {}

  std::size_t size() const noexcept { return size_; }

  /// A place for one request: valid until the queue is changed.
  class Opening;

  /// \param client  of the request (Caller::client).
  /// \return a place for the request: a free one, or that of the newest request of a client with
  ///         more waiting requests, which is dropped and will be resent. None if the request itself
  ///         would have to be dropped, or is already waiting.
  std::optional<Opening> opening_for(const std::string& client, const codec::Head& head) {
    const auto mine = waiting_.find(client);
    const std::size_t count = mine == waiting_.end() ? 0 : mine->second.size();
    auto longest = waiting_.end();
    if (size_ >= capacity_) {  // a flood is mostly this: asked first
      longest = std::ranges::max_element(waiting_, {},
                                         [](const auto& each) { return each.second.size(); });
      if (longest == waiting_.end() || longest->second.size() <= count + 1)
        return std::nullopt;
    }
    if (count > 0 &&
        std::ranges::any_of(mine->second, [&](const Entry& waits) { return waits.head == head; }))
      return std::nullopt;
    return Opening(client, head, longest);
  }

  /// \param opening  of this queue, which was not changed since.
  void push(const Opening& opening, Request&& request, Time held_until = kNow) {
    if (opening.gives_way_ != waiting_.end()) {
      release(opening.gives_way_->second.back());
      opening.gives_way_->second.pop_back();
      --size_;
    }
    auto& mine = waiting_[opening.client_];
    if (mine.empty())
      turns_.push_back(opening.client_);
    mine.emplace_back(opening.head_, std::move(request), held_until);
    ++size_;
    if (held_until != kNow)
      ++held_;
  }

  /// The next request that is not held any more.
  std::optional<std::pair<codec::Head, Request>> pop(Time now) {
    for (auto turn = turns_.begin(); turn != turns_.end(); ++turn) {
      const auto mine = waiting_.find(*turn);
      const auto next = std::ranges::find_if(
          mine->second, [&](const Entry& each) { return each.held_until <= now; });
      if (next == mine->second.end())
        continue;
      turns_.erase(turn);
      release(*next);
      std::optional<std::pair<codec::Head, Request>> request(std::in_place, next->head,
                                                             std::move(next->request));
      mine->second.erase(next);
      --size_;
      if (mine->second.empty())
        waiting_.erase(mine);
      else
        turns_.push_back(mine->first);
      return request;
    }
    return std::nullopt;
  }

  bool holds_some() const noexcept { return held_ > 0; }

  /// Releases a request if it is held.
  void release(const std::string& client, const codec::Head& head) {
    if (const auto mine = waiting_.find(client); held_ > 0 && mine != waiting_.end())
      for (Entry& each : mine->second)
        if (each.head == head)
          release(each);
  }

  /// Releases the held requests for which `is_free` returns true.
  template <typename IsFree>
  void release_if(const IsFree& is_free) {
    for (auto& [client, entries] : waiting_)
      for (Entry& each : entries)
        if (each.held_until != kNow && is_free(each.head, each.request))
          release(each);
  }

  /// When pop() will return a request, unless one is pushed or released before.
  Time next() const {
    if (size_ == 0 || held_ < size_)
      return size_ == 0 ? kNever : kNow;
    Time next = kNever;
    for (const auto& [client, entries] : waiting_)
      for (const Entry& each : entries)
        next = std::min(next, each.held_until);
    return next;
  }

 private:
  struct Entry {
    Entry(const codec::Head& of, Request&& waiting, Time until)
        : head(of), request(std::move(waiting)), held_until(until) {}

    codec::Head head;
    Request request;
    Time held_until;
  };
  using Waiting = std::map<std::string, std::deque<Entry>>;

  void release(Entry& entry) {
    if (entry.held_until != kNow)
      --held_;
    entry.held_until = kNow;
  }

  std::size_t capacity_;
  std::size_t size_ = 0;
  std::size_t held_ = 0;           // of these
  Waiting waiting_;                // none is empty
  std::deque<std::string> turns_;  // each of these once
};

template <typename Request>
class FairQueue<Request>::Opening {
 private:
  friend class FairQueue;
  Opening(std::string client, const codec::Head& head, typename Waiting::iterator gives_way)
      : client_(std::move(client)), head_(head), gives_way_(gives_way) {}

  std::string client_;
  codec::Head head_;
  typename Waiting::iterator gives_way_;  // the end: none has to
};

}  // namespace kinship::dds
