// Every message as Cyclone DDS writes it (XCDR2, little endian), and read from those bytes.

#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>
#include <gtest/gtest.h>

#include <cstring>

#include "proto/codec/admin_codec.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/publication_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "tests/golden/every_value.hpp"
#include "tests/golden/pins.hpp"

namespace kinship::codec::wire_pins_test {
namespace {

constexpr std::uint32_t kXcdr2 = 2;

template <typename Wire>
std::vector<std::uint8_t> bytes_of(const Wire& wire, const dds_topic_descriptor_t& type) {
  dds_ostreamLE_t stream;
  dds_ostreamLE_init(&stream, 0, kXcdr2);
  EXPECT_NE(dds_stream_writeLE(&stream, reinterpret_cast<const char*>(&wire), type.m_ops), nullptr);
  std::vector<std::uint8_t> bytes(stream.x.m_buffer, stream.x.m_buffer + stream.x.m_index);
  dds_ostreamLE_fini(&stream);
  return bytes;
}

/// A message as a reader of Cyclone DDS makes it of bytes.
template <typename Wire>
class Received {
 public:
  Received(const std::vector<std::uint8_t>& bytes, const dds_topic_descriptor_t& type)
      : type_(type) {
    std::memset(&wire_, 0, sizeof wire_);
    dds_istream_t stream;
    dds_istream_init(&stream, static_cast<std::uint32_t>(bytes.size()), bytes.data(), kXcdr2);
    dds_stream_read(&stream, reinterpret_cast<char*>(&wire_), type.m_ops);
  }
  Received(const Received&) = delete;
  Received& operator=(const Received&) = delete;
  ~Received() { dds_stream_free_sample(&wire_, type_.m_ops); }

  const Wire& wire() const { return wire_; }

 private:
  Wire wire_;
  const dds_topic_descriptor_t& type_;
};

const Head kHead{.client_id = test::Distinct(50).id<Uuid>(), .sequence_number = 77};

template <typename Value>
auto encoded(const Value& value) {
  if constexpr (requires { encode(value); })
    return encode(value);
  else
    return encode(kHead, value);
}

template <typename Value>
void check_pin(const std::string& name, const Value& value, const dds_topic_descriptor_t& type) {
  const auto message = encoded(value);
  ASSERT_TRUE(message) << name << ": " << message.error().message;
  using Wire = std::decay_t<decltype(message->wire)>;
  test::expect_pinned_bytes("wire/" + name + ".hex", bytes_of(message->wire, type));
  const Received<Wire> received(test::read_pinned_bytes("wire/" + name + ".hex"), type);
  const Result<Value> back = decode(received.wire());
  ASSERT_TRUE(back) << name << ": " << back.error().message;
  const auto again = encoded(*back);
  ASSERT_TRUE(again) << name << ": " << again.error().message;
  EXPECT_EQ(bytes_of(again->wire, type), bytes_of(message->wire, type)) << name;
}

TEST(WirePins, Register) {
  check_pin("register_request", test::every_robot_description(), kinship_wire_RegisterRequest_desc);
  check_pin("register_reply", test::every_register_reply(), kinship_wire_RegisterReply_desc);
  RobotDescription uploading = test::every_robot_description();
  uploading.contents = {{32, {1, 2, 3}}, {44, {4, 5, 6, 7, 8}}};
  check_pin("register_request_contents", uploading, kinship_wire_RegisterRequest_desc);
}

/// From before there were meshes: never written again.
TEST(WirePins, ARegistrationOfAnOlderClientIsRead) {
  const Received<kinship_wire_RegisterRequest> received(
      test::read_pinned_bytes("wire/register_request_without_meshes.hex"),
      kinship_wire_RegisterRequest_desc);
  const Result<RobotDescription> read = decode(received.wire());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->label, test::every_robot_description().label);
  EXPECT_EQ(read->mesh_solids.unfiltered.size(), 1U);
  EXPECT_TRUE(read->meshes.empty());
  EXPECT_TRUE(read->contents.empty());
}

TEST(WirePins, Report) {
  check_pin("report_request", test::every_report_request(), kinship_wire_ReportRequest_desc);
  check_pin("report_reply", test::every_report_reply(), kinship_wire_ReportReply_desc);
}

TEST(WirePins, Fetch) {
  check_pin("fetch_request", test::every_fetch_request(), kinship_wire_FetchRequest_desc);
  check_pin("fetch_reply", test::every_fetch_reply(), kinship_wire_FetchReply_desc);
  FetchReply reply = test::every_fetch_reply();
  reply.distribution = test::every_kernels();
  check_pin("fetch_reply_kernels", reply, kinship_wire_FetchReply_desc);
  reply.status = FetchStatus::Failed;
  reply.distribution = test::every_failure();
  check_pin("fetch_reply_failed", reply, kinship_wire_FetchReply_desc);
}

TEST(WirePins, Admin) {
  check_pin("admin_request", test::every_admin_request(), kinship_wire_AdminRequest_desc);
  check_pin("admin_reply", test::every_admin_reply(), kinship_wire_AdminReply_desc);
}

TEST(WirePins, Publications) {
  check_pin("announcement", test::every_announcement(), kinship_wire_Announcement_desc);
  check_pin("event", test::every_event(), kinship_wire_Event_desc);
}

}  // namespace
}  // namespace kinship::codec::wire_pins_test
