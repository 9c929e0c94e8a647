#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <thread>

#include "proto/dds/entity.hpp"

namespace kinship::dds {

/// Lets a client with security begin anew where it hears a server and they do not accept each
/// other. Cyclone DDS 0.10.2 judges certificates and permissions when it meets a participant or one
/// of its readers and writers; what it refuses then, e.g. because a clock is wrong for a second, it
/// refuses until it has forgotten that participant. So the client hears and says nothing until the
/// leases on both sides have ended, and both meet for the first time. For sources of proto/dds
/// only.
///
/// All participants of this process in that domain fall silent together. What waits for a server
/// goes on waiting, and what is sent meanwhile is sent again, as after any loss of the network.
class RejoinWatch {
 public:
  /// Of a client in a domain that has no server in this process.
  explicit RejoinWatch(Handle participant);
  ~RejoinWatch();
  RejoinWatch(const RejoinWatch&) = delete;
  RejoinWatch& operator=(const RejoinWatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  using Id = std::uint64_t;  // instance handle
  struct Discovered {
    std::string topic;
    Id participant = 0;
  };

  void run() noexcept;
  void notice();
  bool lacks_a_match() const;
  void fall_silent();

  const Handle participant_;
  // Readers of the built-in topics:
  Entity participants_;
  Entity readers_;
  Entity writers_;
  Entity stop_;
  Entity waitset_;
  std::atomic<bool> is_stopped_ = false;
  // Of the thread alone:
  std::map<Id, bool> is_remote_;  // of each participant that is there
  std::map<Id, Discovered> readers_there_, writers_there_;
  Clock::time_point silent_until_;
  std::thread thread_;  // last: uses the others
};

}  // namespace kinship::dds
