#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "proto/types/conversations.hpp"
#include "proto/types/publications.hpp"

namespace kinship::ros2 {

/// The queries of ROS nodes that follow their distribution: a newer revision is fetched for them
/// and published. May be shared between threads; time is passed in.
class Follows {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMaxOfClient = 256;
  static constexpr std::size_t kMax = 4096;

  /// Keeps a query for as long as it follows, in place of an equal one.
  /// \param client  of its node.
  /// \return false if the node, or all together, have too many.
  bool keep(const std::string& client, const FetchRequest& query, TimePoint now);

  /// Forgets the queries of other nodes: they have left.
  void keep_only(const std::set<std::string>& clients);
  bool empty() const;

  struct Follow {
    std::string client;
    FetchRequest query;  ///< as it was asked, but once and at once
  };
  /// Those whose distribution an announcement may be of.
  std::vector<Follow> of(const Announcement& announcement, TimePoint now);

 private:
  /// Client, task, robot, profile, and the pose of the base to the micrometre.
  using Key = std::pair<std::string, std::string>;
  struct Entry {
    Follow follow;
    TimePoint end;
  };

  template <typename Is>
  void forget_if(const Is& is);
  void forget_ended(TimePoint now);

  mutable std::mutex mutex_;  // guards what follows
  std::map<Key, Entry> entries_;
  std::map<std::string, std::size_t> of_client_;
};

}  // namespace kinship::ros2
