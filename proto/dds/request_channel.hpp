#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "proto/dds/participant.hpp"
#include "proto/dds/wire.hpp"

namespace kinship::dds {

/// The part of a Requester that does not depend on the conversation: sends, resends, and hands
/// each reply to the call that waits for it. For sources of proto/dds only.
///
/// It has no thread of its own: the first caller that sees replies hands them out and wakes the
/// others.
class RequestChannel {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Outcome { Answered, TimedOut, Cancelled };

  RequestChannel(const Participant& participant, const Uuid& client_id, const Topics& topics);

  codec::Head next_head() { return {client_id_, ++last_sequence_number_}; }

  /// \param request   the message, with `head` in it.
  /// \param on_reply  decodes the message; called at most once, before call() returns, maybe on
  ///                  another caller's thread.
  Outcome call(const codec::Head& head, const void* request, Clock::time_point deadline,
               const std::function<void(const void*)>& on_reply);

  void cancel();
  bool has_server() const;        ///< whether one is known now
  std::uint64_t count_servers();  ///< that have appeared since construction, a restarted one again

 private:
  struct Waiter {
    explicit Waiter(const RequestChannel& line);
    Entity guard;
    Entity waitset;
  };
  struct Call {
    const std::function<void(const void*)>& on_reply;
    const Waiter& waiter;
    bool is_answered = false;
  };

  std::unique_ptr<Waiter> acquire_waiter();
  void release_waiter(std::unique_ptr<Waiter> waiter);
  Outcome wait_for_reply(const Call& call, const void* request, Clock::time_point deadline);
  void wait(const Waiter& waiter, Clock::time_point until) const;
  void hand_out_replies(const Call& own);  ///< and wakes other callers
  bool notice_servers();                   ///< whether there is one
  void wake_all();

  Handle participant_;
  bool waits_for_replies_;
  Uuid client_id_;
  std::string name_;
  Entity request_topic_;
  Entity reply_topic_;
  Entity subscriber_;
  Entity reader_;
  Entity condition_;
  Entity publisher_;
  Entity writer_;
  std::atomic<std::uint64_t> last_sequence_number_ = 0;
  std::atomic<std::uint64_t> servers_seen_ = 0;
  std::atomic<bool> is_cancelled_ = false;

  std::mutex mutex_;  // guards what follows and Call::is_answered
  std::map<std::uint64_t, Call*> calls_;
  std::vector<std::unique_ptr<Waiter>> idle_waiters_;
};

}  // namespace kinship::dds
