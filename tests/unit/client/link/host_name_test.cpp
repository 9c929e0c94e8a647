#include "client/link/host_name.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>

namespace kinship::link::host_name_test {
namespace {

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
}  // namespace kinship::link::host_name_test
