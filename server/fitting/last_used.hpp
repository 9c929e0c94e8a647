#pragma once

#include <cstddef>
#include <iterator>
#include <list>
#include <unordered_map>
#include <utility>
#include <vector>

#include "proto/types/digest.hpp"

namespace kinship::fitting {

/// Values by distribution, each with its size in bytes, in the order of their last use, for caches
/// that evict the least recently used value. Not shared between threads.
template <typename Value>
class LastUsed {
 public:
  LastUsed() = default;
  LastUsed(const LastUsed&) = delete;  // the index points into the list
  LastUsed& operator=(const LastUsed&) = delete;

  /// The value, now the last one used; null if there is none. Valid until it is dropped.
  Value* find(const Digest& id) {
    const auto known = index_.find(id);
    if (known == index_.end())
      return nullptr;
    nodes_.splice(nodes_.begin(), nodes_, known->second);
    return &known->second->value;
  }

  /// Replaces the value of this id; it is now the last one used.
  void put(const Digest& id, Value value, std::size_t bytes) {
    erase(id);
    nodes_.push_front({id, std::move(value), bytes});
    index_.emplace(id, nodes_.begin());
    bytes_ += bytes;
  }

  /// Drops the value of this id, if there is one.
  void erase(const Digest& id) {
    if (const auto known = index_.find(id); known != index_.end())
      drop(known->second);
  }

  /// Drops the least recently used value. \pre not empty.
  void drop_oldest() { drop(std::prev(nodes_.end())); }

  /// Ids of the values that fulfil a condition; does not count as a use.
  template <typename Condition>
  std::vector<Digest> ids_of(Condition is_one) const {
    std::vector<Digest> ids;
    for (const Node& node : nodes_)
      if (is_one(node.value))
        ids.push_back(node.id);
    return ids;
  }

  std::size_t size() const noexcept { return index_.size(); }  ///< number of values
  std::size_t bytes() const noexcept { return bytes_; }        ///< of all of them

 private:
  struct Node {
    Digest id;
    Value value;
    std::size_t bytes = 0;
  };
  using Place = typename std::list<Node>::iterator;

  void drop(Place node) {
    bytes_ -= node->bytes;
    index_.erase(node->id);
    nodes_.erase(node);
  }

  std::list<Node> nodes_;  // the one used last comes first
  std::unordered_map<Digest, Place> index_;
  std::size_t bytes_ = 0;
};

}  // namespace kinship::fitting
