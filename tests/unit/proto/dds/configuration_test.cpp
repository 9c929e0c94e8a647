#include <dds/ddsrt/log.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "proto/dds/log.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"
#include "proto/types/failure.hpp"

namespace kinship::dds::configuration_test {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Configuration, PortFollowsTheDomain) {
  EXPECT_EQ(discovery_port(0), 7410);
  EXPECT_EQ(discovery_port(3), 8160);
  EXPECT_EQ(discovery_port(kMaxDomain), 64910);
  EXPECT_EQ(discovery_port(3, 2), 8164);
  EXPECT_LE(server_ports(kMaxDomain, kServerPlaces - 1)[1], 65535);
  EXPECT_THROW(discovery_port(kMaxDomain + 1), Failure);
}

TEST(Configuration, ClientKnowsOnlyThePlacesOfTheServer) {
  const std::string xml = cyclone_configuration({.domain = 3, .server = "10.0.0.7"});
  EXPECT_TRUE(contains(xml, "<ParticipantIndex>none</ParticipantIndex>"));
  std::string peers;
  for (const char* const port : {"8160", "8162", "8164", "8166", "8168", "8170", "8172", "8174"})
    peers += std::string("<Peer address=\"10.0.0.7:") + port + "\"/>";
  EXPECT_TRUE(contains(xml, "<Peers>" + peers + "</Peers>")) << xml;
  EXPECT_FALSE(contains(xml, "NetworkInterface"));
}

TEST(Configuration, LoopbackIsUsedForServersAndForLocalClients) {
  EXPECT_TRUE(contains(cyclone_configuration({.role = Role::Server}), "name=\"lo\""));
  EXPECT_TRUE(contains(cyclone_configuration({.server = "localhost"}), "name=\"lo\""));
  EXPECT_TRUE(contains(cyclone_configuration({.role = Role::Server, .network_interface = "eth0"}),
                       "name=\"eth0\""));
}

TEST(Configuration, ANodeIsFoundAsRosNodesAre) {
  const std::string local = cyclone_configuration({.domain = 7, .role = Role::RosNode});
  EXPECT_TRUE(contains(local, "<ExternalDomainId>7</ExternalDomainId>"));
  EXPECT_TRUE(contains(local, "<ParticipantIndex>auto</ParticipantIndex>"));
  EXPECT_TRUE(contains(local, "name=\"lo\" multicast=\"false\"")) << local;
  EXPECT_TRUE(contains(local, "<Peers><Peer address=\"127.0.0.1\"/></Peers>"));
  const std::string wide =
      cyclone_configuration({.role = Role::RosNode, .network_interface = "eth0"});
  EXPECT_TRUE(contains(wide, "name=\"eth0\"/>")) << wide;
  EXPECT_TRUE(contains(wide, "<AllowMulticast>default</AllowMulticast>"));
  EXPECT_FALSE(contains(wide, "<Peer "));
}

// A first request or reply that is lost is there before the client sends it again after 100 ms.
TEST(Configuration, WhatIsLostIsMissedSoonOnBothSides) {
  for (const Role role : {Role::Server, Role::Client}) {
    const std::string xml = cyclone_configuration({.role = role});
    EXPECT_TRUE(contains(xml, "<HeartbeatInterval>10ms</HeartbeatInterval>"));
    EXPECT_TRUE(contains(xml, "<NackDelay>10ms</NackDelay>"));
  }
}

TEST(Configuration, RefusesNamesThatWouldChangeTheXml) {
  EXPECT_THROW(cyclone_configuration({.server = "a\"/><Peer address=\"b"}), Failure);
  EXPECT_THROW(cyclone_configuration({.server = ""}), Failure);
  EXPECT_THROW(cyclone_configuration({.network_interface = "<lo>"}), Failure);
}

TEST(ReplyPartition, IsTheWorkedExampleOfTheContract) {
  const auto client_id = Uuid::parse("00112233-4455-6677-8899-aabbccddeeff");
  ASSERT_TRUE(client_id);
  EXPECT_EQ(reply_partition(reply_partition_of(*client_id)), "reply_05");
}

TEST(ReplyPartition, SpreadsClientsOverAllPartitions) {
  std::set<unsigned> seen;
  for (int i = 0; i < 1000; ++i)
    seen.insert(reply_partition_of(Uuid::random()));
  EXPECT_EQ(seen.size(), kReplyPartitions);
  EXPECT_LT(*seen.rbegin(), kReplyPartitions);
}

/// Also without memory for a line: an exception would leave locks of Cyclone DDS locked.
TEST(Log, FloodIsCutAndTheNewestLineIsKnown) {
  std::vector<std::string> lines;
  set_log_sink([&](std::string_view line) {
    lines.emplace_back(line);
    if (lines.size() == 2)
      throw std::bad_alloc();
  });
  limit_log();
  for (int i = 0; i < 1000; ++i)
    ASSERT_NO_THROW(dds_log(DDS_LC_ERROR, __FILE__, __LINE__, "test", "malformed packet %d\n", i));
  EXPECT_EQ(lines.size(), 20U);
  EXPECT_EQ(lines.front(), "malformed packet 0");
  EXPECT_EQ(last_log_line(), "malformed packet 999");
  set_log_sink([](std::string_view line) {
    std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
  });
}

}  // namespace
}  // namespace kinship::dds::configuration_test
