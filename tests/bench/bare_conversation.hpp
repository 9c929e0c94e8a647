#pragma once

#include <dds/dds.h>

#include <cstdint>

#include "proto/codec/fetch_codec.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"

/// What a fetch is compared with: the same messages over the same QoS, without anything of ours
/// in between.
namespace kinship::bench {

/// One side of the bare conversation: a writer, a reader and a waitset.
class Bare {
 public:
  Bare(const dds::Participant& participant, bool is_server)
      : participant_(participant.get()),
        request_(topic(participant, kinship_wire_FetchRequest_desc, "bench/request")),
        reply_(topic(participant, kinship_wire_FetchReply_desc, "bench/reply")),
        reader_(dds_create_reader(participant.get(), is_server ? request_.get() : reply_.get(),
                                  is_server ? dds::request_qos().get() : dds::reply_qos().get(),
                                  nullptr),
                "reader"),
        writer_(dds_create_writer(participant.get(), is_server ? reply_.get() : request_.get(),
                                  is_server ? dds::reply_qos().get() : dds::request_qos().get(),
                                  nullptr),
                "writer"),
        condition_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "read condition"),
        waitset_(dds_create_waitset(participant.get()), "waitset") {
    dds::require(dds_waitset_attach(waitset_.get(), condition_.get(), 0), "waitset");
  }

  /// Answers every request with the same reply.
  [[noreturn]] void serve(const FetchReply& answer) {
    codec::Message<kinship_wire_FetchReply> message = codec::encode({}, answer).value_or_throw();
    while (true) {
      wait();
      const dds::Loan requests(reader_, "bench");
      for (std::size_t i = 0; i < requests.size(); ++i) {
        if (!requests[i])
          continue;
        const auto& request = *static_cast<const kinship_wire_FetchRequest*>(requests[i]);
        message.wire.sequence_number = request.sequence_number;
        dds_write(writer_.get(), &message.wire);
      }
    }
  }

  /// Waits until the other side is known in both directions.
  void connect() {
    const dds::Entity matched(dds_create_waitset(participant_), "waitset");
    dds::require(dds_set_status_mask(writer_.get(), DDS_PUBLICATION_MATCHED_STATUS), "status mask");
    dds::require(dds_set_status_mask(reader_.get(), DDS_SUBSCRIPTION_MATCHED_STATUS),
                 "status mask");
    for (const dds_entity_t entity : {writer_.get(), reader_.get()})
      dds::require(dds_waitset_attach(matched.get(), entity, 0), "waitset");
    dds_publication_matched_status_t there{};
    dds_subscription_matched_status_t back{};
    while (there.current_count == 0 || back.current_count == 0) {
      dds_attach_t ready = 0;
      dds_waitset_wait(matched.get(), &ready, 1, DDS_SECS(1));
      dds::require(dds_get_publication_matched_status(writer_.get(), &there), "status");
      dds::require(dds_get_subscription_matched_status(reader_.get(), &back), "status");
    }
  }

  void call(const FetchRequest& fetch) {
    auto request = codec::encode({Uuid{}, ++sequence_number_}, fetch).value_or_throw();
    dds_write(writer_.get(), &request.wire);
    while (true) {
      if (!wait())
        dds_write(writer_.get(), &request.wire);  // was lost: not yet connected
      const dds::Loan replies(reader_, "bench");
      for (std::size_t i = 0; i < replies.size(); ++i)
        if (replies[i] &&
            static_cast<const kinship_wire_FetchReply*>(replies[i])->sequence_number ==
                sequence_number_)
          return;
    }
  }

 private:
  static dds::Entity topic(const dds::Participant& participant,
                           const dds_topic_descriptor_t& descriptor, const char* name) {
    return {dds_create_topic(participant.get(), &descriptor, name, nullptr, nullptr), name};
  }
  /// \return false after a second without a message.
  bool wait() const {
    dds_attach_t ready = 0;
    return dds_waitset_wait(waitset_.get(), &ready, 1, DDS_SECS(1)) > 0;
  }

  dds_entity_t participant_;
  dds::Entity request_, reply_, reader_, writer_, condition_, waitset_;
  std::uint64_t sequence_number_ = 0;
};

}  // namespace kinship::bench
