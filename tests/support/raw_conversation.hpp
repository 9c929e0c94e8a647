#pragma once

#include <dds/dds.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <optional>
#include <string>

#include "proto/dds/loan.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/wire.hpp"
#include "proto/types/result.hpp"

namespace kinship::test {

/// A writer of requests and a reader of their replies, past every check of a client.
template <typename Conversation>
class RawLine {
 public:
  using Request = typename dds::Wire<Conversation>::Request;

  explicit RawLine(const dds::Participant& participant)
      : topics_(dds::Wire<Conversation>::topics()),
        request_topic_(dds_create_topic(participant.get(), &topics_.request,
                                        topics_.request_topic().c_str(), nullptr, nullptr),
                       "request topic"),
        reply_topic_(dds_create_topic(participant.get(), &topics_.reply,
                                      topics_.reply_topic().c_str(), nullptr, nullptr),
                     "reply topic"),
        subscriber_(
            dds_create_subscriber(
                participant.get(),
                dds::partition_qos(dds::reply_partition(dds::reply_partition_of(client_id_))).get(),
                nullptr),
            "subscriber"),
        reader_(dds_create_reader(subscriber_.get(), reply_topic_.get(), dds::reply_qos().get(),
                                  nullptr),
                "reader"),
        writer_(dds_create_writer(participant.get(), request_topic_.get(), dds::request_qos().get(),
                                  nullptr),
                "writer") {}

  codec::Head next_head() { return {client_id_, ++sequence_number_}; }
  const dds::Entity& reader() const { return reader_; }
  const dds::Entity& writer() const { return writer_; }

 private:
  const Uuid client_id_ = Uuid::random();
  std::uint64_t sequence_number_ = 0;
  dds::Topics topics_;
  dds::Entity request_topic_, reply_topic_, subscriber_, reader_, writer_;
};

/// A conversation with a server: what is in the message goes onto the wire as it is. Replies are
/// decoded by the codec.
template <typename Conversation>
class RawConversation {
 public:
  using Request = typename dds::Wire<Conversation>::Request;
  using Reply = typename Conversation::Reply;
  using Clock = std::chrono::steady_clock;

  explicit RawConversation(const dds::Participant& participant)
      : line_(participant),
        condition_(dds_create_readcondition(line_.reader().get(), DDS_ANY_STATE), "read condition"),
        waitset_(dds_create_waitset(participant.get()), "waitset") {
    dds::require(dds_waitset_attach(waitset_.get(), condition_.get(), 0), "waitset");
  }

  /// Fills in the head, sends, and sends again every half second until there is a reply.
  /// \return the reply; nothing if none came in `patience`.
  std::optional<Reply> call(Request request,
                            std::chrono::milliseconds patience = std::chrono::seconds(60)) {
    const codec::Head head = line_.next_head();
    std::ranges::copy(head.client_id.bytes, std::begin(request.client_id));
    request.sequence_number = head.sequence_number;
    const Clock::time_point deadline = Clock::now() + patience;
    while (Clock::now() < deadline) {
      if (dds_get_matched_subscriptions(line_.writer().get(), nullptr, 0) > 0)
        dds_write(line_.writer().get(), &request);
      if (auto reply = wait_for_reply(head, Clock::now() + std::chrono::milliseconds(500)))
        return reply;
    }
    return std::nullopt;
  }

 private:
  std::optional<Reply> wait_for_reply(const codec::Head& head, Clock::time_point until) {
    while (Clock::now() < until) {
      dds_attach_t ready = 0;
      dds_waitset_wait(waitset_.get(), &ready, 1, DDS_MSECS(50));
      const dds::Loan replies(line_.reader(), "replies");
      for (std::size_t i = 0; i < replies.size(); ++i)
        if (replies[i] && dds::head_of(replies[i]) == head)
          return codec::decode(
                     *static_cast<const typename dds::Wire<Conversation>::Reply*>(replies[i]))
              .value_or_throw();
    }
    return std::nullopt;
  }

  RawLine<Conversation> line_;
  dds::Entity condition_, waitset_;
};

}  // namespace kinship::test
