#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <utility>

namespace kinship::runtime {

/// Items of several clients, served round-robin: one of each client that has any, in the order in
/// which clients joined; a client's own in the order of arrival. So a client with one item waits
/// for at most one of each other client. Not shared between threads.
template <typename Item>
class FairQueue {
 public:
  void push(const std::string& client, Item item) {
    std::deque<Item>& own = of_client_[client];
    if (own.empty())
      turns_.push_back(client);
    own.push_back(std::move(item));
    ++size_;
  }

  /// \pre not empty.
  Item pop() {
    const std::string client = std::move(turns_.front());
    turns_.pop_front();
    const auto own = of_client_.find(client);
    Item item = std::move(own->second.front());
    own->second.pop_front();
    --size_;
    if (own->second.empty())
      of_client_.erase(own);
    else
      turns_.push_back(client);
    return item;
  }

  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  std::size_t size_of(const std::string& client) const {
    const auto own = of_client_.find(client);
    return own == of_client_.end() ? 0 : own->second.size();
  }

 private:
  std::map<std::string, std::deque<Item>> of_client_;  // each with an item at least
  std::deque<std::string> turns_;                      // one of each of them
  std::size_t size_ = 0;
};

}  // namespace kinship::runtime
