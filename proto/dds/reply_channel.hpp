#pragma once

#include <compare>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "proto/dds/client_writers.hpp"
#include "proto/dds/matched_readers.hpp"
#include "proto/dds/matched_writers.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/dds/wire.hpp"

namespace kinship::dds {

/// The part of a Replier that does not depend on the conversation: the request reader, a reply
/// writer per partition (with security per client), and the requests being answered. For sources of
/// proto/dds only. May be shared between threads.
class ReplyChannel {
 public:
  /// A request being answered, and its sender.
  struct Place {
    std::string name;  ///< in the certificate; empty without security
    codec::Head head;
    friend auto operator<=>(const Place&, const Place&) = default;
  };

  /// \param loop  whose thread notices clients, with security.
  ReplyChannel(const Participant& participant, WaitLoop& loop, const Topics& topics);

  const Entity& reader() const noexcept { return reader_; }
  const std::string& name() const noexcept { return name_; }

  /// The sender of a request; null if it is not known any more. Valid until the next call.
  /// \param writer  of the sample. Of one thread only.
  Sender* sender(std::uint64_t writer);

  /// Whether a reply would reach a reader of the sender's participant now.
  bool reaches(const Sender& sender, const codec::Head& head);

  const Entity& hearer_came() const noexcept {
    return matched_readers_.guard();
  }  ///< a guard condition

  bool is_being_answered(const Place& place) const;
  bool begin(const Place& place);  ///< false if it is being answered already
  void end(const Place& place);

  std::size_t clients() const;  ///< whose requests would reach it now

  /// \param reply  the message, with the place's head in it.
  void send(const Place& place, const void* reply) noexcept;

 private:
  const Entity& writer_of(const codec::Head& head) const;

  std::string name_;
  Entity request_topic_;
  Entity reply_topic_;
  Entity subscriber_;
  Entity reader_;
  MatchedWriters matched_writers_;
  std::uint64_t departures_ = 0;  // known to matched_writers_
  MatchedReaders matched_readers_;
  std::optional<ClientWriters> client_writers_;  // with security
  std::vector<Entity> publishers_;               // without: one per partition
  std::vector<Entity> writers_;                  // one per partition

  mutable std::mutex mutex_;  // guards being_answered_
  std::set<Place> being_answered_;
};

}  // namespace kinship::dds
