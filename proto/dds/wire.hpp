#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>

#include "proto/codec/admin_codec.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/publication_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "proto/dds/qos.hpp"

/// The messages and topics of each conversation and publication. For sources of proto/dds only.
namespace kinship::dds {

/// Requests that a reader holds until they are taken: a flood sends thousands while the thread that
/// takes them waits for a processor. Fewer in conversations with long requests, to limit memory.
inline constexpr int kHeldRequests = 256;
inline constexpr int kHeldShortRequests = 2048;
/// Of longer requests in a conversation with short ones only some are admitted (message_guard.hpp).
inline constexpr std::size_t kMaxShortRequestBytes = 65'536;
/// The same of paths and robots of ROS nodes, whose trajectories have more than positions.
inline constexpr std::size_t kMaxShortPathBytes = 2 * kMaxSampleBytes;

/// Topics of a conversation, for the type-erased parts.
struct Topics {
  std::string name;  ///< e.g. "fetch": topics kinship/fetch/request and kinship/fetch/reply
  const dds_topic_descriptor_t& request;
  const dds_topic_descriptor_t& reply;
  int held_requests = kHeldRequests;

  std::string request_topic() const { return "kinship/" + name + "/request"; }
  std::string reply_topic() const { return "kinship/" + name + "/reply"; }
};

template <typename Conversation>
struct Wire;

template <>
struct Wire<codec::RegisterConversation> {
  using Request = kinship_wire_RegisterRequest;
  using Reply = kinship_wire_RegisterReply;
  static Topics topics() {
    return {"register", kinship_wire_RegisterRequest_desc, kinship_wire_RegisterReply_desc};
  }
};

template <>
struct Wire<codec::ReportConversation> {
  using Request = kinship_wire_ReportRequest;
  using Reply = kinship_wire_ReportReply;
  static Topics topics() {
    return {"report", kinship_wire_ReportRequest_desc, kinship_wire_ReportReply_desc};
  }
};

template <>
struct Wire<codec::FetchConversation> {
  using Request = kinship_wire_FetchRequest;
  using Reply = kinship_wire_FetchReply;
  static Topics topics() {
    return {"fetch", kinship_wire_FetchRequest_desc, kinship_wire_FetchReply_desc,
            kHeldShortRequests};
  }
};

template <>
struct Wire<codec::AdminConversation> {
  using Request = kinship_wire_AdminRequest;
  using Reply = kinship_wire_AdminReply;
  static Topics topics() {
    return {"admin", kinship_wire_AdminRequest_desc, kinship_wire_AdminReply_desc,
            kHeldShortRequests};
  }
};

/// Topic of a publication, for the type-erased parts.
struct PublicationTopic {
  std::string name;
  const dds_topic_descriptor_t& type;
  Qos qos;  ///< of its writer and its readers
};

template <>
struct Wire<codec::AnnouncementPublication> {
  using Sample = kinship_wire_Announcement;
  static PublicationTopic topic() {
    return {"kinship/announcement", kinship_wire_Announcement_desc, announcement_qos()};
  }
};

template <>
struct Wire<codec::EventPublication> {
  using Sample = kinship_wire_Event;
  static PublicationTopic topic() {
    return {"kinship/event", kinship_wire_Event_desc, event_qos()};
  }
};

/// The first members of every message of a conversation, at their offsets.
struct WireHead {
  std::uint8_t client_id[16];
  std::uint64_t sequence_number;
};

template <typename Message>
constexpr bool kBeginsWithHead = std::is_standard_layout_v<Message>&& offsetof(Message,
                                                                               client_id) == 0 &&
                                 offsetof(Message, sequence_number) ==
                                     offsetof(WireHead, sequence_number);
static_assert(kBeginsWithHead<kinship_wire_RegisterReply> &&
              kBeginsWithHead<kinship_wire_ReportReply> &&
              kBeginsWithHead<kinship_wire_FetchReply> && kBeginsWithHead<kinship_wire_AdminReply>);

/// The head of any message of a conversation.
inline codec::Head head_of(const void* message) {
  WireHead wire;
  std::memcpy(&wire, message, sizeof wire);
  return codec::head_of(wire);
}

}  // namespace kinship::dds
