#include "proto/dds/network_interface.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "proto/dds/participant.hpp"
#include "proto/types/failure.hpp"

namespace kinship::dds {
namespace {

const std::vector<NetworkInterface> kSome{{"lo", {"127.0.0.1"}, true},
                                          {"eth0", {"10.0.0.2"}, true},
                                          {"wlan0", {}, true},
                                          {"eth1", {"10.0.1.2"}, false}};

TEST(NetworkInterface, EveryMachineHasLoopback) {
  const auto all = network_interfaces();
  const auto loopback = std::find_if(
      all.begin(), all.end(), [](const NetworkInterface& each) { return each.name == "lo"; });
  ASSERT_NE(loopback, all.end());
  EXPECT_TRUE(loopback->is_up);
  EXPECT_NE(
      std::find(loopback->addresses.begin(), loopback->addresses.end(), std::string("127.0.0.1")),
      loopback->addresses.end());
  EXPECT_EQ(explain_unusable("lo", all), "");
}

TEST(NetworkInterface, SaysWhatIsWrongAndWhatToDo) {
  const std::string usable = "lo (127.0.0.1), eth0 (10.0.0.2)";
  EXPECT_EQ(explain_unusable("eth7", kSome),
            "network interface 'eth7' does not exist; those that can be used: " + usable);
  EXPECT_EQ(explain_unusable("10.0.0.2", kSome),
            "network interface '10.0.0.2' is an address, that of the interface 'eth0'; name that");
  EXPECT_EQ(explain_unusable("eth1", kSome),
            "network interface 'eth1' is down; switch it on ('ip link set eth1 up'), or take one "
            "that is up: " +
                usable);
  EXPECT_EQ(explain_unusable("wlan0", kSome),
            "network interface 'wlan0' has no IPv4 address; give it one, or take one that has: " +
                usable);
  EXPECT_EQ(explain_unusable("eth0", kSome), "");
}

TEST(NetworkInterface, WhereTheSystemDoesNotTellNothingIsRefused) {
  EXPECT_EQ(explain_unusable("eth7", {}), "");
}

TEST(NetworkInterface, AParticipantOfAMissingInterfaceIsRefusedInWords) {
  try {
    const Participant participant({.domain = 226, .network_interface = "nosuch0"});
    FAIL() << "joined";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Unavailable);
    EXPECT_TRUE(
        std::string(failure.what())
            .starts_with("domain 226: cannot join: network interface 'nosuch0' does not exist; "))
        << failure.what();
  }
}

}  // namespace
}  // namespace kinship::dds
