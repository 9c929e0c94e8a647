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
  EXPECT_THROW(discovery_port(kMaxDomain + 1), Failure);
}

TEST(Configuration, ClientKnowsOnlyTheServer) {
  const std::string xml = cyclone_configuration({.domain = 3, .server = "10.0.0.7"});
  EXPECT_TRUE(contains(xml, "<ParticipantIndex>none</ParticipantIndex>"));
  EXPECT_TRUE(contains(xml, "<Peers><Peer address=\"10.0.0.7:8160\"/></Peers>"));
  EXPECT_FALSE(contains(xml, "NetworkInterface"));
}

TEST(Configuration, LoopbackIsUsedForServersAndForLocalClients) {
  EXPECT_TRUE(contains(cyclone_configuration({.role = Role::Server}), "name=\"lo\""));
  EXPECT_TRUE(contains(cyclone_configuration({.server = "localhost"}), "name=\"lo\""));
  EXPECT_TRUE(contains(cyclone_configuration({.role = Role::Server, .network_interface = "eth0"}),
                       "name=\"eth0\""));
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
