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

  /// Room for one request: as long as nothing else is done to the queue.
  class Opening;

  /// \param client  whose turn it is (Caller::client).
  /// \return room for the request: there is some, or of somebody else more wait, of whom the newest
  ///         has to go then, and is sent again. None if it would have to go itself, or waits
  ///         already.
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
        std::ranges::any_of(mine->second, [&](const auto& waits) { return waits.first == head; }))
      return std::nullopt;
    return Opening(client, head, longest);
  }

  /// \param opening  of this queue, to which nothing was done since.
  void push(const Opening& opening, Request request) {
    if (opening.gives_way_ != waiting_.end()) {
      opening.gives_way_->second.pop_back();
      --size_;
    }
    auto& mine = waiting_[opening.client_];
    if (mine.empty())
      turns_.push_back(opening.client_);
    mine.emplace_back(opening.head_, std::move(request));
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
  using Waiting = std::map<std::string, std::deque<std::pair<codec::Head, Request>>>;

  std::size_t capacity_;
  std::size_t size_ = 0;
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
  typename Waiting::iterator gives_way_;  // the end: nobody has to
};

}  // namespace kinship::dds
