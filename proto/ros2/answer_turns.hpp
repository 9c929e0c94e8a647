#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "proto/codec/conversation.hpp"
#include "proto/dds/peer_table.hpp"

namespace kinship::ros2 {

/// When answers are sent: at once, or those beyond a node's rate in its turn. Until then its
/// question is being answered, so that it need not be asked again. In bounded memory. May be shared
/// between threads; time is passed in.
class AnswerTurns {
 public:
  using TimePoint = dds::TokenBucket::TimePoint;
  using Place = std::pair<std::string, codec::Head>;  ///< a node and its question
  struct Answer {
    std::shared_ptr<const void> sample;
    std::size_t bytes = 0;          ///< of memory
    std::uint64_t participant = 0;  ///< of the node
    bool may_wait = true;           ///< false: it holds for now only
  };
  enum class Turn {
    Now,
    Later,
    Never  ///< its node asks again
  };

  static constexpr dds::TokenBucket::Rate kRate{.per_s = 100, .burst = 100};  ///< to a node
  static constexpr std::size_t kMaxHeldOfNode = 4096;                         ///< answers
  static constexpr std::size_t kMaxHeldBytes = 16UL << 20U;                   ///< of all nodes

  bool begin(const Place& place);  ///< \return false if it is being answered
  void end(const Place& place);

  /// Keeps the answer if its turn is later; else, also if it throws, the question ends.
  /// \throws std::bad_alloc
  Turn take(const Place& place, const Answer& answer, TimePoint now);

  /// The samples whose turn has come; their questions end.
  std::vector<std::shared_ptr<const void>> due(TimePoint now);

  /// Ends the questions whose answers wait for participants that have gone.
  void drop_if(const std::function<bool(std::uint64_t participant)>& is_gone);

  bool holds_some() const;

 private:
  struct Held {
    codec::Head question;
    Answer answer;  // shared with nobody
  };
  struct Line {
    dds::TokenBucket tokens;
    std::deque<Held> held;
  };

  Turn turn_of(const Place& place, const Answer& answer, TimePoint now);
  Line& line_of(const std::string& node, TimePoint now);

  mutable std::mutex mutex_;  // guards what follows
  std::set<Place> being_answered_;
  std::map<std::string, Line> lines_;  // by node
  std::size_t held_bytes_ = 0;         // of all lines
};

}  // namespace kinship::ros2
