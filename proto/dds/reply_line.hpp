#pragma once

#include <mutex>
#include <set>
#include <vector>

#include "proto/dds/participant.hpp"
#include "proto/dds/wire.hpp"

namespace kinship::dds {

/// The part of a Replier that does not depend on the conversation: the request reader, a reply
/// writer per partition, and which requests are being answered. For sources of proto/dds only.
/// May be shared between threads.
class ReplyLine {
 public:
  ReplyLine(const Participant& participant, const Topics& topics);

  const Entity& reader() const noexcept { return reader_; }
  const std::string& name() const noexcept { return name_; }

  bool is_being_answered(const codec::Head& head) const;
  bool begin(const codec::Head& head);  ///< false: it is being answered already
  void end(const codec::Head& head);

  std::size_t clients() const;  ///< whose requests would reach it now

  /// \param reply  the message, with `head` in it.
  void send(const codec::Head& head, const void* reply) const noexcept;

 private:
  std::string name_;
  Entity request_topic_;
  Entity reply_topic_;
  Entity reader_;
  std::vector<Entity> publishers_;  // one per partition
  std::vector<Entity> writers_;     // one per partition

  mutable std::mutex mutex_;  // guards being_answered_
  std::set<codec::Head> being_answered_;
};

}  // namespace kinship::dds
