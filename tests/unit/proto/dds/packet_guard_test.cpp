#include "proto/dds/packet_guard.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_guid.h>
#include <dds/ddsi/ddsi_plist.h>
#include <dds/ddsrt/sockets.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "tests/unit/proto/dds/datagrams.hpp"

// Of headers of Cyclone DDS that are no C++.
struct addrset;
extern "C" {
addrset* new_addrset(void);
bool ddsi_new_proxy_participant(ddsi_domaingv*, const ddsi_guid*, std::uint32_t, const ddsi_guid*,
                                addrset*, addrset*, const ddsi_plist*, dds_duration_t,
                                nn_vendorid_t, unsigned, ddsrt_wctime_t, seqno_t);
}

namespace kinship::dds::packet_guard_test {
namespace {

using test::Bytes;

/// What Cyclone DDS reads of datagrams that a socket of this machine sends.
class PacketGuardTest : public testing::Test {
 public:
  PacketGuardTest(const PacketGuardTest&) = delete;
  PacketGuardTest& operator=(const PacketGuardTest&) = delete;
  ~PacketGuardTest() override { close(socket_); }

 protected:
  PacketGuardTest() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(socket_, generic, size), 0);
    EXPECT_EQ(getsockname(socket_, generic, &size), 0);
    EXPECT_EQ(connect(socket_, generic, size), 0) << "to itself";
  }
  std::optional<Bytes> heard_of(const Bytes& datagram) const {
    EXPECT_EQ(send(socket_, datagram.data(), datagram.size(), 0),
              static_cast<ssize_t>(datagram.size()));
    Bytes buffer(65'536);
    iovec part{buffer.data(), buffer.size()};
    sockaddr_storage source{};
    ddsrt_msghdr_t message{};
    message.msg_name = &source;
    message.msg_namelen = sizeof source;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    ssize_t size = 0;
    if (ddsrt_recvmsg(socket_, &message, 0, &size) != DDS_RETCODE_OK)
      return std::nullopt;
    buffer.resize(static_cast<std::size_t>(size));
    return buffer;
  }

  const int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const PacketGuard guard_{false};
};

TEST_F(PacketGuardTest, TakesThePartsOfStrangersOutOfADatagram) {
  const GuidPrefix first{1, 1}, stranger{2, 2}, last{3, 3};
  const Bytes life = test::submessage(0x07, 1, Bytes(28));
  const auto part = [](const GuidPrefix& sender, const Bytes& what) {
    Bytes bytes = test::source_submessage(sender);
    test::append(bytes, what);
    return bytes;
  };
  Bytes expected = test::announcement({.sender = first});
  Bytes datagram = expected;
  test::append(datagram, part(stranger, life));
  for (Bytes* const bytes : {&datagram, &expected})
    test::append(*bytes, part(last, test::announcement_submessage({.sender = last})));
  EXPECT_EQ(heard_of(datagram), expected);
  Bytes of_a_stranger = test::rtps_header(stranger), of_the_last = of_a_stranger;
  test::append(of_a_stranger, life);
  EXPECT_EQ(heard_of(of_a_stranger), std::nullopt);
  datagram = of_a_stranger;
  for (Bytes* const bytes : {&datagram, &of_the_last})
    test::append(*bytes, part(last, life));
  EXPECT_EQ(heard_of(datagram), of_the_last);
}

TEST_F(PacketGuardTest, LetsNoParticipantBeMadeThatHasNotAnnouncedItself) {
  ddsi_guid guid{};
  guid.prefix.u[0] = 77;
  guid.entityid.u = 0x1c1;
  EXPECT_FALSE(ddsi_new_proxy_participant(nullptr, &guid, 0, nullptr, new_addrset(), new_addrset(),
                                          nullptr, DDS_INFINITY, {{1, 16}}, 0, {0}, 0));
}

}  // namespace
}  // namespace kinship::dds::packet_guard_test
