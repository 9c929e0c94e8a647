#include "client/link/environment.hpp"

#include <gtest/gtest.h>

#include <unistd.h>
#include <array>
#include <cstdlib>

#include "client/link/host_name.hpp"
#include "proto/types/failure.hpp"

namespace kinship::link::environment_test {
namespace {

class Environment : public testing::Test {
 protected:
  void SetUp() override { clear(); }
  void TearDown() override { clear(); }

  static void clear() {
    unsetenv("KINSHIP_DOMAIN");
    unsetenv("KINSHIP_SERVER");
    unsetenv("KINSHIP_TIMEOUT");
  }
};

TEST_F(Environment, WhatIsNotSaidIsAsOptionsHaveIt) {
  EXPECT_EQ(options_from_environment().domain, 0U);
  EXPECT_EQ(options_from_environment().server, ClientOptions().server);
}

TEST_F(Environment, DomainAndServerAreTaken) {
  setenv("KINSHIP_DOMAIN", "230", 1);
  setenv("KINSHIP_SERVER", "10.0.0.7", 1);
  EXPECT_EQ(options_from_environment().domain, 230U);
  EXPECT_EQ(options_from_environment().server, "10.0.0.7");
}

TEST_F(Environment, ADomainThatIsNoneIsRefusedByName) {
  for (const char* const text : {"231", "-1", "7a", " 7", "99999999999"}) {
    setenv("KINSHIP_DOMAIN", text, 1);
    try {
      options_from_environment();
      FAIL() << "taken: " << text;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code(), ErrorCode::InvalidInput);
      EXPECT_EQ(std::string(failure.what()),
                "KINSHIP_DOMAIN '" + std::string(text) + "' is not a domain from 0 to 230");
    }
  }
}

TEST_F(Environment, ATimeoutIsTakenOrRefusedByName) {
  setenv("KINSHIP_TIMEOUT", "0.25", 1);
  EXPECT_EQ(options_from_environment().timeout, std::chrono::milliseconds(250));
  for (const char* const text : {"0", "-1", "5s", "nan", "86401"}) {
    setenv("KINSHIP_TIMEOUT", text, 1);
    EXPECT_THROW(options_from_environment(), Failure) << text;
  }
}

TEST(HostName, AddressesAreKnownAndSomeNamesAreNot) {
  for (const char* const known : {"127.0.0.1", "localhost", "192.0.2.1"})
    EXPECT_EQ(why_unknown(known), "") << known;
  EXPECT_NE(why_unknown("nobody..invalid"), "");
}

TEST(HostName, TellsThisMachineFromOthers) {
  std::array<char, 256> name{};
  ASSERT_EQ(gethostname(name.data(), name.size() - 1), 0);
  for (const std::string here : {"127.0.0.1", "127.1.2.3", "localhost", "::1"})
    EXPECT_TRUE(is_this_machine(here)) << here;
  EXPECT_TRUE(is_this_machine(name.data()));
  EXPECT_FALSE(is_this_machine("192.0.2.1"));
  EXPECT_FALSE(is_this_machine(std::string(name.data()) + ".elsewhere.invalid"));
}

}  // namespace
}  // namespace kinship::link::environment_test
