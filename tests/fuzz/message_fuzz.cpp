// Bytes from the network as any of the messages: what Cyclone DDS lets pass is refused in words, or
// is a value that can be sent again and comes back.

#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata_default.h>

#include <array>
#include <cstring>
#include <functional>
#include <optional>
#include <vector>

#include "proto/codec/admin_codec.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/publication_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "proto/dds/message_guard.hpp"
#include "tests/fuzz/demand.hpp"

namespace kinship::fuzz {
namespace {

constexpr std::uint32_t kXcdr2 = 2;

/// A message as a reader of Cyclone DDS makes it of bytes that it holds for well formed.
template <typename Wire>
class Received {
 public:
  Received(std::vector<std::uint8_t> bytes, bool swapped, const dds_topic_descriptor_t& type)
      : type_(type) {
    bytes.reserve(1);  // never null
    std::uint32_t end = 0;
    const auto size = static_cast<std::uint32_t>(bytes.size());
    ddsi_sertype_default known{};  // what of it is looked at
    known.type.ops = {type.m_nops, const_cast<std::uint32_t*>(type.m_ops)};
    well_formed_ = dds_stream_normalize(bytes.data(), size, swapped, kXcdr2, &known, false, &end);
    if (!well_formed_)
      return;
    dds_istream_t stream;
    dds_istream_init(&stream, size, bytes.data(), kXcdr2);
    dds_stream_read(&stream, reinterpret_cast<char*>(&wire_), type.m_ops);
  }
  Received(const Received&) = delete;
  Received& operator=(const Received&) = delete;
  ~Received() {
    if (well_formed_)
      dds_stream_free_sample(&wire_, type_.m_ops);
  }

  bool well_formed() const { return well_formed_; }
  const Wire& wire() const { return wire_; }

 private:
  bool well_formed_ = false;
  Wire wire_{};
  const dds_topic_descriptor_t& type_;
};

template <typename Value>
auto encoded(const Value& value) {
  if constexpr (requires { codec::encode(value); })
    return codec::encode(value);
  else
    return codec::encode(codec::Head{}, value);
}

template <typename Wire>
void try_message(const std::vector<std::uint8_t>& bytes, bool swapped,
                 const dds_topic_descriptor_t& type) {
  const Received<Wire> received(bytes, swapped, type);
  if (!received.well_formed())
    return;
  const auto value = codec::decode(received.wire());
  demand_words(value);
  if (!value)
    return;
  const auto message = encoded(*value);
  if (!message) {
    demand(message.error().code == ErrorCode::TooLarge,
           "what was decoded can be sent: " + message.error().message);
    return;
  }
  const auto again = codec::decode(message->wire);
  demand(again.has_value(), "what was sent can be decoded");
  demand(encoded(*again).has_value(), "what came back can be sent again");
}

using Try = void (*)(const std::vector<std::uint8_t>&, bool swapped);

template <typename Wire, const dds_topic_descriptor_t& kType>
void try_as(const std::vector<std::uint8_t>& bytes, bool swapped) {
  try_message<Wire>(bytes, swapped, kType);
}

/// By the first byte of the input, whose highest bit says that the bytes are swapped; the order is
/// that of the seeds in `run`.
constexpr std::array<Try, 10> kMessages = {
    try_as<kinship_wire_AdminReply, kinship_wire_AdminReply_desc>,
    try_as<kinship_wire_AdminRequest, kinship_wire_AdminRequest_desc>,
    try_as<kinship_wire_Announcement, kinship_wire_Announcement_desc>,
    try_as<kinship_wire_Event, kinship_wire_Event_desc>,
    try_as<kinship_wire_FetchReply, kinship_wire_FetchReply_desc>,
    try_as<kinship_wire_FetchRequest, kinship_wire_FetchRequest_desc>,
    try_as<kinship_wire_RegisterReply, kinship_wire_RegisterReply_desc>,
    try_as<kinship_wire_RegisterRequest, kinship_wire_RegisterRequest_desc>,
    try_as<kinship_wire_ReportReply, kinship_wire_ReportReply_desc>,
    try_as<kinship_wire_ReportRequest, kinship_wire_ReportRequest_desc>};

}  // namespace
}  // namespace kinship::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool kGuarded = kinship::dds::is_message_guard_in_place();
  kinship::fuzz::demand(kGuarded, "messages are guarded");
  if (size == 0)
    return 0;
  kinship::fuzz::kMessages.at((data[0] & 0x7fU) % kinship::fuzz::kMessages.size())(
      {data + 1, data + size}, (data[0] & 0x80U) != 0);
  return 0;
}
